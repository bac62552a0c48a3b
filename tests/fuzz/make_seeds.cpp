// make_fuzz_seeds FOLDER: a small whole file of each kind, for the fuzzer to begin with.
#include <filesystem>
#include <fstream>
#include <iostream>

#include "core/io/small_files.h"

namespace {

std::string fromHex(const std::string& text) {
  std::string bytes;
  for (std::size_t i = 0; i + 1 < text.size(); i += 3)
    bytes += static_cast<char>(std::stoi(text.substr(i, 2), nullptr, 16));
  return bytes;
}

// The first byte of a seed says how large the pieces are. Telegrams, and the insides of some.
template <class Seed>
void seedInstruments(const Seed& seed) {
  int number = 0;
  for (const char* telegram :
       {"05 06 02 80 0A 00 B0 03 00 F4 01 F5 01 F6 01 10 42 08", "3F 06 02 80 03 00 A0 00 10 16 0A 15",
        "01 02 80 07 00 BB 01 B4 00 32 00 10 03 9D", "02 02 00 01 00 31 15 12", "00 B0 01 20 F4 01 10",
        "00 B0 01 40 FF 1F 22 11 90", "00 B6 04 01 00 F4 01 10", "00 B7 01 00 02 00 02 00 F4 01 F5 01 10",
        "00 BF 02 01 00 01 00 01 00 F4 01 10", "00 BE 01 00 01 00 01 00 F4 01 00 00 01 00 02 00 10",
        "00 C4 01 00 F4 01 01 00 01 00 01 00 0A 10", "00 F5 01 00 01 00 01 00 01 00 F4 01 E0 2E 10",
        "00 BB 00 B4 00 32 00 10", "00 B2 03 11 02 05 13", "00 92 D4"})
    seed("lms2xx", ("telegram" + std::to_string(number++)).c_str(), fromHex(telegram));
  seed("lms2xx", "configuration", "0\xF4" + std::string(34, '\1') + "\x10");
  seed("lms2xx", "written", "0\xF7\1" + std::string(34, '\1') + "\x10");
  seed("lms2xx", "status", "0\xB1" + std::string(152, '2') + "\x10");
  seed("lms2xx", "numbers", "0" + fromHex("01 00 69 01"));
  seed("lms2xx", "type", "0\xBALMS291;S14;V02.10 \x10");
  seed("mip50", "answers",
       "\x07\r\nX0\r\nM#21    1      42800\r\n\r\nX0E#180 1 'A'\r\nP0 ASCII - Commandmode\r\nM#26 1 33 "
       "5700\r\n");
  seed("mip50", "commands", "0E1xGC1x2r2t0.2GV1x100Gn1xGf1xGH1xGA1x42800GR1x-6945GP1xGq1x33pGw1x33p5700G");
  seed("mip50", "table",
       "0clear_error = E{axis}xG\nanswer_s = 2.5\nrefusal.180 = off\nerror.3 = \\x41\\s\\r # remark\nrepeats "
       "= 4\n");
  for (const char* frame :
       {"01 90 02 68 04 01 7A 60 00 A0 86 01 00 3E AB", "05 90 02 00 04 00 00 00 00 01 90 90 00 00 9A 5C",
        "11 11 03 40 60 00 01 06 00 00 00 C3 71", "02 00 01 00 00 02 06 B5 20",
        "03 90 02 10 02 41 60 00 01 64 CF", "04 90 02 60 02 01 41 90 02 60 02 01 41 60 00 22 D1"})
    seed("epos", ("frame" + std::to_string(number++)).c_str(), fromHex(frame));
  seed("cola", "scan",
       "1\x02sSN LMDscandata 1 1 89A27F 0 2 3 3 27477BA9 2747813B 0 0 7 0 0 1388 168 1 5 -5 1 DIST1 3F800000 "
       "00000000 FFF92230 1388 3 3E8 0 1 1 RSSI1 3F800000 00000000 186A0 1388 3 E8 E9 EA 0 0 0 0 0\x03");
  seed("cola", "words",
       "9\x02sMN mLMPsetscancfg +2500 +1 +2500 -450000 +2250000\x03\x02sFA 2\x03\x02sRA STlms 7\x03");
  seed("cola", "binary", "3" + fromHex("02 02 02 02 00 00 00 07 73 4D 4E 20 52 75 6E 19 02 73 03"));
  seed("scip", "quit", "4QT\n00P\n\n");
  seed("scip", "parameters",
       "8PP\n00P\nMODL:URG;@\nDMIN:20;4\nDMAX:5600;_\nARES:1024;\\\nAMIN:44;7\nAMAX:725;o\nAFRT:384;6\n"
       "SCAN:600;e\n\n");
  seed("scip", "scan", "7MD0000000201000\n99b\nm2@0?\n1Dh1Dh1DhG\n\n");
  seed("scip", "order", "2ME0000108003207\n");
  seed("wire", "session",
       "# tiltmap wire session 1\n# lms2xx:x\n# begun 5.0\n0.1 = 9600 8N1\n0.2 > 02 00\n0.3 < 06\n0.4 ! "
       "gone\n");
}

}  // namespace

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
  seedInstruments(seed);
  return 0;
}
