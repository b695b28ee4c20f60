// Closed components of the pressure system: bodies of water that nowhere touch air (no e). In such a body p is known up
// to a constant only, and there is a solution only if the right-hand side sums to zero: the means of both are taken
// out.
//
// Components are found as runs of linked cells along pencils, joined across pencils by union-find.
#pragma once

#include <houle/pressure/pencils.hpp>

namespace houle::multigrid {

// The closed components of a system. After find(), remove_means() takes the mean of a field over each of them out.
template <int D>
class ClosedComponents {
 public:
  explicit ClosedComponents(const Layout<D>& l) {
    const index most = l.pencils * ((l.n[D - 1] + 1) / 2);
    runs_.reserve(most);
    run_start_.assign(l.pencils + 1, 0);
    sealed_.assign(l.pencils, 0);
    sums_.reserve(most);
  }

  int count() const { return closed_; }

  template <class Note>
  void note_buffers(Note note) const {
    note(runs_);
    note(sums_);
  }

  // k (faces), e (cells): the system on the active cells of the mask.
  void find(const Layout<D>& l, const Mask<D>& active, ConstFaces<D> k, const double* e) {
    const index n = l.n[D - 1];
    closed_ = 0;
    runs_.clear();
    if (!any_sealed(l, active, k, e)) return;
    for (index p = 0; p < l.pencils; ++p) {
      run_start_[p] = static_cast<index>(runs_.size());
      if (l.first[p] >= l.last[p]) continue;
      const Pencil row = l.pencil(p);
      const std::uint8_t* mask = active.pencil(l.place(p));
      const double* up = k[D - 1] + p * (n + 1);
      for (index j = l.first[p]; j < l.last[p];) {
        if (!mask[j]) {
          ++j;
          continue;
        }
        const index start = j;
        bool open = e[p * n + j] > 0;
        for (++j; j < l.last[p] && mask[j] && up[j] > 0; ++j) open = open || e[p * n + j] > 0;
        runs_.push_back({row.at, static_cast<std::int32_t>(start), static_cast<std::int32_t>(j), row.parity,
                         static_cast<std::int32_t>(runs_.size()), open});
      }
    }
    run_start_[l.pencils] = static_cast<index>(runs_.size());
    for (index p = 0; p < l.pencils; ++p) join_neighbours(l, p, k);
    for (int r = 0; r < static_cast<int>(runs_.size()); ++r) {  // roots come first
      Run& run = runs_[r];
      if (run.parent == r)
        run.parent = run.open ? -1 : ~(++closed_);
      else
        run.parent = runs_[run.parent].parent;
    }
    if (closed_ == 0) return;
    for (auto& run : runs_) run.parent = run.parent == -1 ? -1 : ~run.parent - 1;
    sums_.assign(closed_, {0, 0});
  }

  // Takes the mean over each closed component out of f.
  void remove_means(const Field<double>& f) {
    if (closed_ == 0) return;
    for (auto& s : sums_) s = {0, 0};
    auto entry = [&](const Run& r, index j) -> double& { return f.c[(r.parity + j) & 1][r.at + j / 2]; };
    for (const Run& r : runs_) {
      if (r.parent < 0) continue;
      for (index j = r.first; j < r.last; ++j) sums_[r.parent].value += entry(r, j);
      sums_[r.parent].cells += r.last - r.first;
    }
    for (const Run& r : runs_) {
      if (r.parent < 0) continue;
      const double mean = sums_[r.parent].value / static_cast<double>(sums_[r.parent].cells);
      for (index j = r.first; j < r.last; ++j) entry(r, j) -= mean;
    }
  }

 private:
  struct Run {
    index at;
    std::int32_t first, last, parity;
    std::int32_t parent;  // union-find; after find(): number of its closed component or -1
    bool open;
  };
  struct Sum {
    double value;
    index cells;
  };
  std::vector<Run> runs_;
  std::vector<index> run_start_;
  std::vector<std::uint8_t> sealed_;  // pencils with a run without air
  std::vector<Sum> sums_;
  int closed_ = 0;

  // True if some run touches no air by itself: if none does, no component is closed.
  bool any_sealed(const Pencils<D>& l, const Mask<D>& active, ConstFaces<D> k, const double* e) {
    const index n = l.n[D - 1];
    std::uint8_t* sealed = sealed_.data();
    parallel_for(
        l.pencils,
        [=](index p) {
          sealed[p] = 0;
          if (l.first[p] >= l.last[p]) return;
          const std::uint8_t* mask = active.pencil(l.place(p));
          const double *up = k[D - 1] + p * (n + 1), *air = e + p * n;
          bool open = true;  // the run touches air, as far as it is known
          for (index j = l.first[p]; j < l.last[p]; ++j) {
            if (!mask[j]) continue;
            const bool linked = j > l.first[p] && mask[j - 1] && up[j] > 0;
            if (!linked && !open) sealed[p] = 1;
            open = air[j] > 0 || (linked && open);
          }
          if (!open) sealed[p] = 1;
        },
        l.grain);
    return std::find(sealed_.begin(), sealed_.end(), 1) != sealed_.end();
  }

  int root(int r) {
    while (runs_[r].parent != r) r = runs_[r].parent = runs_[runs_[r].parent].parent;
    return r;
  }
  void join(int a, int b) {
    a = root(a);
    b = root(b);
    if (a == b) return;
    if (b < a) std::swap(a, b);
    runs_[b].parent = a;
    runs_[a].open = runs_[a].open || runs_[b].open;
  }

  void join_neighbours(const Layout<D>& l, index p, ConstFaces<D> k) {
    const index n = l.n[D - 1];
    if (run_start_[p] == run_start_[p + 1]) return;
    const auto i = l.place(p);
    if (l.wrap[D - 1] && k[D - 1][p * (n + 1)] > 0 && runs_[run_start_[p]].first == 0 &&
        runs_[run_start_[p + 1] - 1].last == n)
      join(static_cast<int>(run_start_[p]), static_cast<int>(run_start_[p + 1] - 1));
    for (int a = 0; a < D - 1; ++a) {
      if (i[a] == 0 && !l.wrap[a]) continue;
      index face = 0, q = 0;
      for (int t = 0; t < D - 1; ++t) {
        face = face * (l.n[t] + (t == a)) + i[t];
        q = q * l.n[t] + (t == a ? (i[t] + l.n[t] - 1) % l.n[t] : i[t]);
      }
      const double* link = k[a] + face * n;
      index x = run_start_[p], y = run_start_[q];
      while (x < run_start_[p + 1] && y < run_start_[q + 1]) {
        const index from = std::max(runs_[x].first, runs_[y].first), to = std::min(runs_[x].last, runs_[y].last);
        for (index j = from; j < to; ++j)
          if (link[j] > 0) {
            join(static_cast<int>(x), static_cast<int>(y));
            break;
          }
        if (runs_[x].last < runs_[y].last)
          ++x;
        else
          ++y;
      }
    }
  }
};

}  // namespace houle::multigrid
