// Begins a block of pixels behind a lens, as POV-Ray would: with the environment's settings, which may be refused.
#include "bridge.h"

int main()
{
    if (nfp_enabled())
        nfp_block_begin(0, 0, 8, 8, 1, nullptr, 0);
}
