/* The sampler that each device makes of a number, after noisefloor_sampler.h: of all kinds. expected.h makes the same
 * by the library.
 */
NFS_FUNCTION nfs sampler_of(nfs_uint i)
{
    nfs_uint a = nfs_mix(i), b = nfs_mix(i ^ 0x5bd1e995u), k;
    nfs s = nfs_pixel(a, b, i % 3u, b >> (a & 31u));
    s.flags = i & 2u;
    for (k = 0u; k < i % 4u; ++k)
        s = nfs_domain(s, a ^ k);
    return nfs_scramble(s, i % 5u);
}
