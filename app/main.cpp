#include <cstdio>

int main() {
  std::puts("tiltmap " TILTMAP_VERSION);
  return 0;
}
