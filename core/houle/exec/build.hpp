// The build of the library: its compiler, flags and variant.
#pragma once

namespace houle {

struct Build {
  const char* compiler;
  const char* flags;
  const char* variant;  // portable: any processor, v3: x86-64-v3 (AVX2), own: as HOULE_ARCH asks
};

Build build_of_core();

}  // namespace houle
