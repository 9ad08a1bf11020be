#pragma once
#include <hmf/hmf.hpp>

hmf::Hierarchy build();
double energy(const hmf::Foliation& foliation);
