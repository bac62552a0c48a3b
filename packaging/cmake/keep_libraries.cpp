// Only in builds with the address sanitizer: libraries stay loaded until the program has ended. A graphics driver that is
// unloaded before leaks are looked for takes the pointers to its memory along, and everything it still held is reported
// as leaked, from a place without a name. The program's own definition comes before the C library's.
extern "C" int dlclose(void* /*library*/) noexcept { return 0; }
