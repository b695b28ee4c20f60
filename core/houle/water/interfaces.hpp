// Interfaces, where porous bodies and clear water (or two bodies) meet, as the particles and faces near them know them.
//
// Across an interface the Darcy velocity is continuous. Along it, it is not: drag, inertia and porosity differ. So a
// particle sees the faces of its own side only, with their weights divided by their sum. One component it sees as
// everywhere: that across an interface parallel to the faces of its axis, for it is known on the interface itself. A
// particle gives to the faces with the same weights. They sum to 1, so momentum is conserved and uniform flow is kept;
// as near a wall of the tank, the velocity is constant over the last half cell. See docs/decisions/0017.
#pragma once

#include <houle/grid/kernels.hpp>

namespace houle {

// The two sides of a gate: an Interface has these numbers in place of those of media (GATE of medium/interfaces.py).
constexpr double before_gate = -3.0, behind_gate = -2.0;

// The interface nearest to the centre of a cell, as a plane, and the media on its two sides. For a gate beside the cell
// the sides of the gate take the place of the media, and a face belongs to the side on which it lies.
template <int D>
struct Interface {
  double normal[D];
  double offset;        // normal . x on it [m]
  double below, above;  // medium where normal . x is less, and more

  bool beyond(const double* x) const {
    double s = -offset;
    for (int a = 0; a < D; ++a) s += normal[a] * x[a];
    return s >= 0.0;
  }
  double side(const double* x) const { return beyond(x) ? above : below; }  // the medium there
  int axis() const {  // normal to it, -1: oblique (PARALLEL of medium/interfaces.py)
    for (int a = 0; a < D; ++a)
      if (std::abs(normal[a]) > 1.0 - 1e-9) return a;
    return -1;
  }
  // True if water that passes the faces of axis a crosses it: it is parallel, or nearly, to them (ALONG of
  // medium/interfaces.py).
  bool across(int a) const { return normal[a] * normal[a] > 0.99; }
};

// All interfaces and gates of a tank: which of them is near to each cell, and the medium of each face.
template <int D>
struct Interfaces {
  const std::int32_t* number = nullptr;  // cells: row of the list, -1: no interface near; null: none at all
  const std::int32_t* close = nullptr;   // the same; -1 also where the linear kernel meets faces of one medium only
  const Interface<D>* list = nullptr;
  std::array<double, D> slices{};     // 1 over the number of faces of each axis in a slice across the first
  double spacing = 0;                 // size of a cell along the first axis [m]
  ConstFaces<D, std::int8_t> medium;  // at the centre of each face; -1: in a solid, on no side

  // The interface that a particle in this cell must look at, if it sees faces by the kernel K; null: none.
  template <class K>
  const Interface<D>* near(index cell) const {
    const std::int32_t k = (std::is_same_v<K, LinearKernel> ? close : number)[cell];
    return k < 0 ? nullptr : list + k;
  }
  // The interface nearest to the centre of this cell; null: none near.
  const Interface<D>* in(index cell) const { return number[cell] < 0 ? nullptr : list + number[cell]; }
  // True if face f of axis a lies on that side of the interface. A face in a solid counts on both.
  bool is_own(const Interface<D>& at, int a, index f, double side) const {
    if (side > behind_gate) return medium[a][f] == side || medium[a][f] < 0;
    return (std::floor((static_cast<double>(f) + 0.5) * slices[a]) + 0.5) * spacing >= at.offset ? side == behind_gate
                                                                                                 : side == before_gate;
  }
};

// The two functions below that are not inlined take copies: the loops around them, in which few particles are beside an
// interface, keep their own numbers in registers.

// The weights of the linear kernel for these faces of axis a, as a particle at x beside that interface sees them.
template <int D, std::size_t count>
HOULE_NOINLINE inline std::array<double, count> own_weights(const Interfaces<D> media, int a, const Interface<D>* at,
                                                            const std::array<double, D> x,
                                                            const std::array<index, count> face,
                                                            std::array<double, count> weight) {
  if (at->across(a)) return weight;
  const double side = at->side(x.data());
  double sum = 0.0;
  for (std::size_t k = 0; k < count; ++k) sum += media.is_own(*at, a, face[k], side) ? weight[k] : 0.0;
  if (!(sum > LinearKernel::least_own)) return weight;
  for (std::size_t k = 0; k < count; ++k) weight[k] = media.is_own(*at, a, face[k], side) ? weight[k] / sum : 0.0;
  return weight;
}

// A copy of the point x (D,).
template <int D>
inline std::array<double, D> point(const double* x) {
  std::array<double, D> at;
  std::copy_n(x, D, at.begin());
  return at;
}

// The faces that a particle beside an interface sees, with weights that sum to 1. It is the same class for every
// kernel, and what is computed with it is compiled once for all of them.
template <int D>
class Beside {
 public:
  // Fills the lists: the particle at x, of that edge [m], sees faces by the kernel K; at: the interface nearest to it.
  // Returns whether it sees fewer faces than there are around it.
  template <class K>
  HOULE_NOINLINE bool look(const Grid<D>& g, const std::array<std::array<index, D>, D>& stride,
                           const Interfaces<D>& media, const Interface<D>& at, const double* x, Edge edge) {
    static_assert(K::width <= widest);
    Stencil<K, D> stencil;
    stencil.set(g, x, edge);
    const double own_side = at.side(x);
    double total[D];
    bool cut = false;
    each_of<D>([&](auto a) {
      each_of<D>([&](auto b) { first_[a][b] = stencil.template along<a, b>().first; });
      double all = 0.0, own = 0.0;
      Face* end = faces_[a];
      stencil.template each<a>(stride[a], [&](index f, double w, double sign, const std::array<int, D>& k) {
        const bool is_own = media.is_own(at, a, f, own_side);
        all += w;
        own += is_own ? w : 0.0;
        *end++ = {f, w, sign, k, is_own};
      });
      const bool part = !at.across(a) && own > K::least_own * all;
      cut = cut || (part && own != all);
      count_[a] = static_cast<int>(end - faces_[a]);
      total[a] = 1.0 / (part ? own : all);
      part_[a] = part;
    });
    if (cut) divide(total);
    return cut;
  }

  // visit(axis, face, weight, sign of the mirrored normal component, offsets)
  template <class Visit>
  void each(Visit visit) const {
    for (int a = 0; a < D; ++a)
      for (const Face *f = faces_[a], *end = f + count_[a]; f < end; ++f) visit(a, f->face, f->weight, f->sign, f->k);
  }

  template <class Field>
  std::array<double, D> gather(const Field& v) const {
    std::array<double, D> value{};
    each([&](int a, index f, double w, double sign, const auto&) { value[a] += w * sign * v[a][f]; });
    return value;
  }

  // From the particle to a face of axis a, as Stencil::distance() [m].
  std::array<double, D> distance(const Grid<D>& g, int a, const std::array<int, D>& k) const {
    std::array<double, D> r;
    for (int b = 0; b < D; ++b) r[b] = (first_[a][b] + k[b]) * g.h[b];
    return r;
  }

 private:
  static constexpr int widest = GaussianKernel::width;
  struct Face {
    index face;
    double weight, sign;
    std::array<int, D> k;
    bool own;
  };
  Face faces_[D][D == 2 ? widest * widest : widest * widest * widest];
  int count_[D];
  bool part_[D];        // it sees its own faces only
  double first_[D][D];  // way to the first face of each axis [cells]

  // Leaves the faces that the particle sees, with their weights divided by the sum of these.
  void divide(const double (&total)[D]) {
    for (int a = 0; a < D; ++a) {
      Face* kept = faces_[a];
      for (Face *f = kept, *end = f + count_[a]; f < end; ++f) {
        if (part_[a] && !f->own) continue;
        *kept = *f;
        kept++->weight *= total[a];
      }
      count_[a] = static_cast<int>(kept - faces_[a]);
    }
  }
};

// The rarer part of beside_interface(): a particle near to an interface.
template <class K, int D, class Body>
HOULE_NOINLINE inline bool see_less(const Grid<D> g, const std::array<std::array<index, D>, D> stride,
                                    const Interfaces<D> media, const Interface<D>* at, const std::array<double, D> x,
                                    Edge edge, const Body body) {
  Beside<D> beside;
  const bool less = beside.template look<K>(g, stride, media, *at, x.data(), edge);
  if (less) body(beside);
  return less;
}

// Calls body(beside) and returns true where the particle at x, with that stencil, sees less than all faces around it.
template <class K, int D, class Body>
[[gnu::always_inline]] inline bool beside_interface(const Grid<D>& g, const std::array<std::array<index, D>, D>& stride,
                                                    const Interfaces<D>& media, const Stencil<K, D>& st,
                                                    const double* x, Edge edge, const Body& body) {
  if (!media.number) return false;
  const Interface<D>* at = media.template near<K>(cell_of(g, st, x));
  return at && see_less<K, D>(g, stride, media, at, point<D>(x), edge, body);
}

}  // namespace houle
