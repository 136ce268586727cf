/* Succeeds if MDEBR multiplies two short numbers, as the s390x manual says. QEMU before 8.1 takes one for long. */
int main(void)
{
    register double product __asm__("f0");
    register double factor __asm__("f2");
    __asm__("llihf 1,0x40400000\n\tldgr %0,1\n\tldgr %1,1\n\tmdebr %0,%1" : "=&f"(product), "=&f"(factor) : : "1");
    return product == 9.0 ? 0 : 1;
}
