// The build of the library: its compiler, flags and variant.
#pragma once

namespace houle {

struct Build {
  const char* compiler;
  const char* flags;
  const char* variant;  // portable: the compiler's baseline, v3: x86-64-v3, own: as was asked for
};

Build build_of_core();

}  // namespace houle
