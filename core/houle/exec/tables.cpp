#include <algorithm>

#include <houle/exec/tables.hpp>

namespace houle {

namespace {

template <class T>
Ends<T> ends(const T* table, index n) {
  T least = table[0], most = table[0];
  for (index i = 1; i < n; ++i) least = std::min(least, table[i]), most = std::max(most, table[i]);
  return {least, most};
}

template <class T>
bool is_growing(const T* table, index n, bool strictly) {
  bool falls = false, stays = false;
  for (index i = 1; i < n; ++i) {
    falls |= table[i] < table[i - 1];
    stays |= table[i] == table[i - 1];
  }
  return !falls && !(strictly && stays);
}

}  // namespace

Ends<std::int32_t> ends_of(const std::int32_t* table, index n) { return ends(table, n); }
Ends<std::int64_t> ends_of(const std::int64_t* table, index n) { return ends(table, n); }
bool grows(const std::int32_t* table, index n, bool strictly) { return is_growing(table, n, strictly); }
bool grows(const std::int64_t* table, index n, bool strictly) { return is_growing(table, n, strictly); }

}  // namespace houle
