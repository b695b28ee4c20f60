// The full mass matrix of the linear kernel, M_fg = sum_p m_p w_fp w_gp over the faces f, g of one axis, and with it
// the transfer FMPM(k) of add_residual(): the sums over the particles are taken once, and each further term is a
// stencil of 3^D points on the grid, sum_p m_p w_fp (u_p - (interpolated velocity)_p) = sum_p m_p w_fp u_p - (M v)_f.
//
// The matrix is symmetric: stored are the links of a node to itself and to the half of its neighbours that comes after
// it in memory, one array per link. Rows of nodes (along the last axis) are stored as far up as water reaches.
#pragma once

#include <span>
#include <vector>

#include <houle/water/transfer.hpp>

namespace houle {

// The matrix of a grid, made anew in every transfer().
template <int D>
class MassMatrix {
 public:
  explicit MassMatrix(const Grid<D>& g) : grid_(g), top_(static_cast<std::size_t>(g.cells() / g.shape[up])) {}

  const Grid<D>& grid() const { return grid_; }

  // The transfer: velocity and mass (faces) as to_faces() gives them with the linear kernel, with order - 1 times
  // add_residual() after it. work (faces): work space; lent: more of it for the matrix, which takes memory of its own
  // only if that is too small.
  // where (faces, or null): 1 on faces that take `more` terms beyond these, 0 on all others.
  void transfer(const Cloud<D>& cloud, const double* u, int order, Faces<D> velocity, Faces<D> mass, Faces<D> work,
                std::span<double> lent, ConstFaces<D, std::uint8_t> where = {}, int more = 0);

 private:
  static constexpr int up = D - 1, links = D == 2 ? 5 : 14, corners = 1 << D;

  struct Row {
    index first;   // place of its first node in each array
    index height;  // nodes, from the bottom
  };

  // The matrix of one axis as loops know it, and its product with a field.
  struct Links {
    Grid<D> grid;
    std::array<index, D> shape{};  // shape of the faces
    index line = 0;                // faces in a row
    index around = 0;              // nodes in a row: on a periodic axis the last face is no node of its own
    const Row* row = nullptr;
    double* store = nullptr;  // momentum sum_p m_p w_fp u_p, then the links: arrays of `nodes`
    index nodes = 0;

    // out += factor (M v) on row r; v (faces) null: 1
    void add_product(index r, double factor, const double* v, double* out) const {
      const auto i = Grid<D>::unflat(r, rows_of<D>(shape));
      for (int l = 0; l < links; ++l) {
        auto o = offset_of(l);
        const index after = beside(i, o, 1);
        if (after >= 0) add_link(l, r, r, after, 0, o[up], factor, v, out);
        const index before = beside(i, o, -1);
        if (before >= 0 && l > 0) add_link(l, r, before, before, -o[up], -o[up], factor, v, out);
      }
    }

    // The row at `times` the offset from row i, -1 if there is none.
    index beside(const std::array<index, D>& i, const std::array<int, D>& offset, int times) const {
      const auto stride = Grid<D>::strides(rows_of<D>(shape));
      index found = 0;
      for (int b = 0; b < up; ++b) {
        index j = i[b] + times * offset[b];
        if (grid.periodic[b]) j = (j + grid.shape[b]) % grid.shape[b];
        if (j < 0 || j >= shape[b]) return -1;
        found += j * stride[b];
      }
      return found;
    }

    // out[k] += factor c[k + s] v[k + t] on row r, with c link l on row `from`, v on row `to`
    void add_link(int l, index r, index from, index to, index s, index t, double factor, const double* v,
                  double* out) const {
      const double* c = store + (1 + l) * nodes + row[from].first + s;
      const double* x = v ? v + to * line + t : nullptr;
      const index begin = std::max<index>({0, -s, -t});
      const index end = std::min({row[r].height, row[from].height - s, around - t});
      if (x) {
        HOULE_INDEPENDENT
        for (index k = begin; k < end; ++k) out[k] += factor * c[k] * x[k];
      } else {
        HOULE_INDEPENDENT
        for (index k = begin; k < end; ++k) out[k] += factor * c[k];
      }
      if (!grid.periodic[up] || t == 0 || row[r].height == 0 || row[from].height == 0) return;
      const index k = t > 0 ? around - 1 : 0, turn = t > 0 ? -around : around;  // across the periodic ends
      out[k] += factor * c[k + (s == 0 ? 0 : turn)] * (x ? x[k + turn] : 1.0);
    }
  };

  Grid<D> grid_;
  std::vector<std::int32_t> top_;  // one more than the highest cell with particles, for each row of cells
  std::vector<Row> rows_;
  std::vector<double> own_;  // memory of the matrix where none is lent
  Links now_;                // the matrix of the present axis

  // Number of the link from a corner of a particle's stencil to the same or a later one: the offset (-1, 0 or 1 along
  // every axis, the first that is not 0 positive) read as a number to the base 3.
  static constexpr int link_between(int from, int to) {
    int number = 0;
    for (int a = 0; a < D; ++a) number = 3 * number + ((to >> (up - a)) & 1) - ((from >> (up - a)) & 1);
    return number;
  }
  static std::array<int, D> offset_of(int link) {
    std::array<int, D> o{};
    for (int a = up; a >= 0; --a) {
      o[a] = (link + 1) % 3 - 1;
      link = (link + 1) / 3;
    }
    return o;
  }

  void find_tops(const std::int32_t* start) {
    const index nz = grid_.shape[up];
    std::int32_t* top = top_.data();
    parallel_for(
        static_cast<index>(top_.size()),
        [=](index r) {
          const std::int32_t* cell = start + r * nz;
          index k = nz;
          while (k > 0 && cell[k] == cell[k - 1]) --k;
          top[r] = static_cast<std::int32_t>(k);
        },
        64);
  }

  // The rows of the faces of an axis: a particle reaches one node beyond its cell, along every axis.
  void list_rows(int a, std::span<double> lent) {
    const auto shape = grid_.face_shape(a);
    const index line = shape[up], around = grid_.periodic[up] ? grid_.shape[up] : line;
    const auto rows = rows_of<D>(shape), cells = rows_of<D>(grid_.shape);
    const auto stride = Grid<D>::strides(cells);
    rows_.resize(static_cast<std::size_t>(grid_.faces(a) / line));
    index nodes = 0;
    for (index r = 0; r < static_cast<index>(rows_.size()); ++r) {
      const auto i = Grid<D>::unflat(r, rows);
      bool own = true;  // not the repetition of the first on a periodic axis
      for (int b = 0; b < up; ++b) own = own && (!grid_.periodic[b] || i[b] < grid_.shape[b]);
      index top = 0;
      for (int q = 0; q < (D == 2 ? 3 : 9); ++q) {
        std::array<index, D> j{};
        int code = q;
        for (int b = 0; b < up; ++b, code /= 3) j[b] = inside(i[b] + code % 3 - 1, cells[b], grid_.periodic[b]);
        top = std::max<index>(top, top_[Grid<D>::flat(j, stride)]);
      }
      const index height = top == 0 || !own ? 0 : (grid_.periodic[up] ? around : std::min(top + 1, line));
      rows_[r] = {nodes, height};
      nodes += height;
    }
    const auto wanted = static_cast<std::size_t>((links + 1) * nodes);
    if (wanted > lent.size() && wanted > own_.size()) own_.resize(wanted);
    now_ = {grid_, shape, line, around, rows_.data(), wanted <= lent.size() ? lent.data() : own_.data(), nodes};
  }

  // The cell of a particle that reaches these nodes of the faces of axis a.
  template <int a>
  static index cell_of(const Grid<D>& g, const Reach<LinearKernel> (&reach)[D]) {
    index cell = 0;
    each_of<D>([&](auto b) {
      const auto& r = reach[b];
      const index i = b == a ? std::min(r.node[0], g.shape[b] - 1) : r.node[r.weight[1] < 0.5 ? 0 : 1];
      cell = cell * g.shape[b] + i;
    });
    return cell;
  }

  template <int a>
  void sum_particles(const Cloud<D>& cloud, const double* u) {
    const Grid<D> g = grid_;
    const auto stride = Grid<D>::strides(rows_of<D>(now_.shape));
    const Row* rows = now_.row;
    const index nodes = now_.nodes, line = now_.line;
    const Interfaces<D> media = cloud.media;
    double* store = now_.store;
    each_row([=](index, const Row& row, index) {
      for (int l = 0; l <= links; ++l) std::fill_n(store + l * nodes + row.first, row.height, 0.0);
    });
    each_slab(g, cloud.start, [=](index begin, index end) {
      for (index p = begin; p < end; ++p) {
        Reach<LinearKernel> reach[D];
        each_of<D>([&](auto b) {
          reach[b].set(cloud.x[D * p + b] / g.h[b] - (b == a ? 0.0 : 0.5), {}, b == a, g.shape[b], g.periodic[b]);
          if (!g.periodic[b] && reach[b].node[0] == reach[b].node[1]) {  // beside a wall: one node
            reach[b].weight[0] = 1.0;
            reach[b].weight[1] = 0.0;
          }
        });
        bool stored = true;  // all nodes it reaches have a place: so if it lies in the cell where `start` has it
        unrolled<corners>([&](auto c) {
          index row = 0;
          each_of<D>([&](auto b) {
            if (b < up) row += reach[b].node[(c >> (up - b)) & 1] * stride[b];
          });
          stored = stored && reach[up].node[c & 1] < rows[row].height;
        });
        if (!stored) continue;
        std::array<index, corners> node;
        std::array<double, corners> weight;
        unrolled<corners>([&](auto c) {
          index row = 0;
          double w = 1.0;
          each_of<D>([&](auto b) {
            constexpr int side = (c >> (up - b)) & 1;
            w *= reach[b].weight[side];
            if (b < up) row += reach[b].node[side] * stride[b];
          });
          node[c] = rows[row].first + reach[up].node[c & 1];
          weight[c] = w;
        });
        if (media.number) {
          if (const auto* at = media.template near<LinearKernel>(cell_of<a>(g, reach))) {
            std::array<index, corners> face;
            unrolled<corners>([&](auto c) {
              index row = 0;
              each_of<D>([&](auto b) {
                if (b < up) row += reach[b].node[(c >> (up - b)) & 1] * stride[b];
              });
              face[c] = row * line + reach[up].node[c & 1];
            });
            weight = own_weights<D, corners>(media, a, at, point<D>(cloud.x + D * p), face, weight);
          }
        }
        const double m = cloud.mass[p], mu = m * u[D * p + a];
        unrolled<corners>([&](auto c) {
          double* at = store + node[c];
          const double mw = m * weight[c];
          *at += weight[c] * mu;
          unrolled<corners - c>([&](auto after) {
            constexpr int d = c + after;
            at[(1 + link_between(c, d)) * nodes] += mw * weight[d];
          });
        });
      }
    });
  }

  // Calls visit(row, first face of the row) for every row of faces.
  template <class Visit>
  void each_row(Visit visit) const {
    const Row* rows = now_.row;
    const index line = now_.line;
    parallel_for(static_cast<index>(rows_.size()), [=](index r) { visit(r, rows[r], r * line); }, 16);
  }

  // mass = M 1, the weights of a particle having the sum 1; velocity = momentum / mass.
  void divide(double* mass, double* velocity) const {
    const Links now = now_;
    each_row([=](index r, const Row& row, index face) {
      double *m = mass + face, *v = velocity + face;
      const double* momentum = now.store + row.first;
      std::fill(m, m + now.line, 0.0);
      now.add_product(r, 1.0, nullptr, m);
      HOULE_INDEPENDENT
      for (index k = 0; k < row.height; ++k) v[k] = m[k] > 0.0 ? momentum[k] / m[k] : 0.0;
      std::fill(v + row.height, v + now.line, 0.0);
    });
  }

  // next = before + (momentum - M before) / mass
  void refine(const double* mass, const double* before, double* next) const {
    const Links now = now_;
    each_row([=](index r, const Row& row, index face) {
      const double *m = mass + face, *v = before + face, *momentum = now.store + row.first;
      double* w = next + face;
      std::copy(momentum, momentum + row.height, w);
      std::fill(w + row.height, w + now.line, 0.0);
      now.add_product(r, -1.0, before, w);
      HOULE_INDEPENDENT
      for (index k = 0; k < row.height; ++k) w[k] = m[k] > 0.0 ? v[k] + w[k] / m[k] : 0.0;
    });
  }

  // refine() on the faces where `where` is not 0; the others keep their velocity.
  void refine_at(const std::uint8_t* where, const double* mass, const double* before, double* next) const {
    const Links now = now_;
    each_row([=](index r, const Row& row, index face) {
      const double *m = mass + face, *v = before + face, *momentum = now.store + row.first;
      const std::uint8_t* at = where + face;
      double* w = next + face;
      if (std::none_of(at, at + row.height, [](std::uint8_t one) { return one != 0; })) {
        std::copy(v, v + now.line, w);
        return;
      }
      std::copy(momentum, momentum + row.height, w);
      std::copy(v + row.height, v + now.line, w + row.height);
      now.add_product(r, -1.0, before, w);
      HOULE_INDEPENDENT
      for (index k = 0; k < row.height; ++k) w[k] = v[k] + (at[k] && m[k] > 0.0 ? w[k] / m[k] : 0.0);
    });
  }
};

template <int D>
void MassMatrix<D>::transfer(const Cloud<D>& cloud, const double* u, int order, Faces<D> velocity, Faces<D> mass,
                             Faces<D> work, std::span<double> lent, ConstFaces<D, std::uint8_t> where, int more) {
  const int terms = where[0] ? order + more : order;
  find_tops(cloud.start);
  each_of<D>([&](auto axis) {
    constexpr int a = decltype(axis)::value;
    double *now = terms % 2 ? velocity[a] : work[a], *next = terms % 2 ? work[a] : velocity[a];
    list_rows(a, lent);
    sum_particles<a>(cloud, u);
    divide(mass[a], now);
    for (int k = 1; k < order; ++k, std::swap(now, next)) refine(mass[a], now, next);
    for (int k = order; k < terms; ++k, std::swap(now, next)) refine_at(where[a], mass[a], now, next);
  });
  close_periodic(grid_, mass);
  close_periodic(grid_, velocity);
}

}  // namespace houle
