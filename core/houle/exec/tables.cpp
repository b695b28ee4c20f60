#include <algorithm>
#include <cstdint>

#include <houle/exec/tables.hpp>

namespace houle {

template <class T>
Ends<T> ends_of(const T* table, index n) {
  T least = table[0], most = table[0];
  for (index i = 1; i < n; ++i) least = std::min(least, table[i]), most = std::max(most, table[i]);
  return {least, most};
}

template <class T>
bool grows(const T* table, index n, bool strictly) {
  bool falls = false, stays = false;
  for (index i = 1; i < n; ++i) {
    falls |= table[i] < table[i - 1];
    stays |= table[i] == table[i - 1];
  }
  return !falls && !(strictly && stays);
}

template Ends<std::int32_t> ends_of(const std::int32_t*, index);
template Ends<std::int64_t> ends_of(const std::int64_t*, index);
template bool grows(const std::int32_t*, index, bool);
template bool grows(const std::int64_t*, index, bool);

}  // namespace houle
