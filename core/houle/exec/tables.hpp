// Checks of index tables, which are looked at before loops trust them: as fast as the loops, as they are made in each
// call.
#pragma once

#include <cstdint>

#include <houle/exec/loop.hpp>

namespace houle {

template <class T>
struct Ends {
  T least, most;
};

// The smallest and the largest of n >= 1 numbers.
Ends<std::int32_t> ends_of(const std::int32_t* table, index n);
Ends<std::int64_t> ends_of(const std::int64_t* table, index n);

// True if each of the n numbers is at least as large as the one before it; strictly: larger.
bool grows(const std::int32_t* table, index n, bool strictly);
bool grows(const std::int64_t* table, index n, bool strictly);

}  // namespace houle
