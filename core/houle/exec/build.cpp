#include <houle/exec/build.hpp>

#define HOULE_TEXT_OF(number) #number
#define HOULE_TEXT(number) HOULE_TEXT_OF(number)

namespace houle {

Build build_of_core() {
#if defined(__clang__)
  constexpr const char* compiler = "clang " __clang_version__;
#elif defined(__GNUC__)
  constexpr const char* compiler = "gcc " __VERSION__;
#elif defined(_MSC_VER)
  constexpr const char* compiler = "msvc " HOULE_TEXT(_MSC_FULL_VER);
#else
  constexpr const char* compiler = "unknown";
#endif
  return {compiler, HOULE_FLAGS, HOULE_VARIANT};  // from CMake
}

}  // namespace houle
