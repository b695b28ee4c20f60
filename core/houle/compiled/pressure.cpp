// The pressure system and its solver, compiled.
#include <houle/compiled/lists.hpp>

namespace houle {

HOULE_PRESSURE(HOULE_COMPILE)
template class PressureSolver<2>;
template class PressureSolver<3>;

}  // namespace houle
