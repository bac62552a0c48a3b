// make_fuzz_seeds FOLDER: a small whole file of each kind, for the fuzzer to begin with.
#include <filesystem>
#include <fstream>
#include <iostream>

#include "core/io/small_files.h"

int main(int argc, char** argv) {
  using namespace tiltmap::test;
  if (argc != 2) {
    std::cerr << "usage: make_fuzz_seeds FOLDER\n";
    return 2;
  }
  const std::filesystem::path folder = argv[1];
  const auto seed = [&](const char* target, const char* name, const std::string& bytes) {
    const auto place = folder / (std::string("fuzz_") + target);
    std::filesystem::create_directories(place);
    std::ofstream(place / name, std::ios::binary) << bytes;
  };
  seed("pcd", "ascii", asciiPcd());
  seed("pcd", "binary", binaryPcd());
  seed("pcd", "compressed", compressedPcd());
  seed("ply", "ascii", asciiPly());
  seed("ply", "little", littlePly());
  seed("ply", "big", bigPly());
  seed("ply", "grid",
       "ply\nformat ascii 1.0\ncomment tiltmap world_from_scan 1 2 3 0 0 0 1\nobj_info num_cols 2\nobj_info "
       "num_rows 2\n"
       "element vertex 2\nproperty float x\nproperty float y\nproperty float z\nelement range_grid 4\n"
       "property list uchar int vertex_indices\nend_header\n1 2 3\n4 5 6\n1 0\n0\n0\n1 1\n");
  seed("ptx", "one", ptx());
  seed("ptx", "two", ptx() + ptx());
  seed("vtk", "ascii", asciiVtk());
  seed("vtk", "binary", binaryVtk());
  seed("uos", "counts", uos());
  seed("uos", "grid", "2 3\n100 1 200\n1 1 200\n-100 1 200\n100 20 200\n1 20 200\n-100 20 200\n");
  seed("xyz", "columns", xyz());
  seed("xyz", "names", csv());
  seed("xyz", "commas", "1,5;2,5;3,5;10\n4,5;5,5;6,5;20\n");
  seed("poses", "tum", "# index x y z qx qy qz qw\n0 0 0 0 0 0 0 1\n1 1 2 3 0 0 0.6 0.8\n");
  seed("poses", "pose", "1 2 3\n4 5 6\n");
  return 0;
}
