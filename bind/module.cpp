// The Python module houle._core_<variant>: the bindings, with the core compiled for these processors. This is the only
// file of bind/ that is compiled for each variant. houle._core is the widest of them that the processor runs.
#include <nanobind/nanobind.h>

#include <stdexcept>

namespace houle {

void bind_all(nanobind::module_& m);

// True if this processor has the instructions of the variant. Nothing of the core may run before that is known.
static bool processor_runs_it() {
#if defined(HOULE_IS_v3)
  return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") && __builtin_cpu_supports("bmi") &&
         __builtin_cpu_supports("bmi2");
#else
  return true;
#endif
}

}  // namespace houle

#define HOULE_NB_MODULE(name, m) NB_MODULE(name, m)  // expands the name first

HOULE_NB_MODULE(HOULE_MODULE, m) {
  if (!houle::processor_runs_it()) throw nanobind::import_error("this processor has no AVX2 and FMA");
  houle::bind_all(m);
}
