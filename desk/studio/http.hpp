#pragma once

#include <httplib.h>

// Of the system's resolver, which httplib brings along: Eigen has parameters of that name.
#ifdef _res
#undef _res
#endif
