// Sorting, and transfer with the linear kernel, compiled.
#include <houle/compiled/lists.hpp>

namespace houle {

HOULE_CELLS(HOULE_COMPILE)
HOULE_BESIDE(HOULE_COMPILE)
HOULE_TRANSFER(HOULE_COMPILE_OF, LinearKernel)
template class MassMatrix<2>;
template class MassMatrix<3>;

}  // namespace houle
