// hmf.h: structures with their defaults.
#include "entry.hpp"

#include "../solve/solve.hpp"

using namespace hmf;

extern "C" {

void hmf_control_init(hmf_control* control, uint32_t struct_size) { init_options(control, struct_size, {}); }

void hmf_hierarchy_options_init(hmf_hierarchy_options* options, uint32_t struct_size) {
    init_options<hmf_hierarchy_options>(options, struct_size, BuildOptions());
}

void hmf_solve_options_init(hmf_solve_options* options, uint32_t struct_size) {
    init_options<hmf_solve_options>(options, struct_size, SolveOptions());
}

} // extern "C"
