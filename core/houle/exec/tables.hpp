// Checks of index tables, which are looked at before loops trust them: as fast as the loops, as they are made in each
// call.
#pragma once

#include <houle/exec/loop.hpp>

namespace houle {

template <class T>
struct Ends {
  T least, most;
};

// Compiled for std::int32_t and std::int64_t. The smallest and the largest of n >= 1 numbers.
template <class T>
Ends<T> ends_of(const T* table, index n);

// Compiled for the same. True if each of the n numbers is at least as large as the one before it; strictly: larger.
template <class T>
bool grows(const T* table, index n, bool strictly);

}  // namespace houle
