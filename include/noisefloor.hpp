// noisefloor for C++17: thin wrappers over noisefloor.h.
#ifndef NOISEFLOOR_HPP
#define NOISEFLOOR_HPP

#include "noisefloor.h"

#endif
