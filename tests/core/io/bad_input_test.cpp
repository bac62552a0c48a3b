// What is not whole is refused, by every reader: with the file's name, without a crash, and without room made
// for counts that the file does not bear out.
#include <stdexcept>
#include <sys/resource.h>

#include <gtest/gtest.h>

#include "core/base/random.h"
#include "core/io/scan_reader.h"
#include "small_files.h"
#include "support/child_process.h"
#include "support/temporary_folder.h"

namespace tiltmap {
namespace {

using namespace test;

struct BadFile {
  std::string name;
  ScanFormat format;
  std::string bytes;
  std::string where;  // what `where` must hold beside the file's name
};

void PrintTo(const BadFile& bad, std::ostream* out) {
  *out << bad.name;
}

void expectRefused(const std::filesystem::path& path, ScanFormat format, const std::string& where) {
  const auto result = readScans(path, {format, 0.0, 0.0});
  ASSERT_FALSE(result);
  EXPECT_NE(result.error().where.find(path.filename().string() + where), std::string::npos)
      << result.error().where;
  EXPECT_FALSE(result.error().what.empty());
  EXPECT_FALSE(result.error().remedy.empty());
  for (const char c : result.error().what) EXPECT_GE(static_cast<unsigned char>(c), 32) << "safe to print";
}

std::string noise(std::size_t length, std::uint64_t seed) {
  RandomStream random(seed);
  std::string bytes;
  for (std::size_t i = 0; i < length; ++i) bytes += static_cast<char>(random.below(256));
  return bytes;
}

std::vector<BadFile> badFiles() {
  std::vector<BadFile> list;
  const auto add = [&](const char* name, ScanFormat format, std::string bytes, std::string where = "") {
    list.push_back({scanFormatName(format) + "_" + name, format, std::move(bytes), std::move(where)});
  };
  for (const auto& [word, format] : scanFormatNames()) {
    if (format == ScanFormat::Auto) continue;
    add("Empty", format, "");
    add("OneLineEnd", format, "\n");
    add("Noise", format, noise(5000, 1));
    add("Zeros", format, std::string(300, '\0'));
  }
  const ScanFormat pcd = ScanFormat::Pcd;
  const std::string a = asciiPcd(), b = binaryPcd(), c = compressedPcd();
  add("HeaderOnly", pcd, pcdHeader("ascii"));
  add("HeaderOnlyBinary", pcd, pcdHeader("binary"));
  add("HeaderOnlyCompressed", pcd, pcdHeader("binary_compressed"));
  add("HeaderCut", pcd, a.substr(0, 60));
  add("TooShort", pcd, replaced(a, "7 8 9.5 30\n", ""), ":14");
  add("TooLong", pcd, a + "1 1 1 1\n", ":15");
  add("TooFewWords", pcd, replaced(a, "4 5 6 20", "4 5 6"), ":13");
  add("TooManyWords", pcd, replaced(a, "4 5 6 20", "4 5 6 20 3"), ":13");
  add("WordForNumber", pcd, replaced(a, "4 5 6", "4 five 6"), ":13");
  add("HexNumber", pcd, replaced(a, "4 5 6", "4 0x5 6"), ":13");
  add("Overflow", pcd, replaced(a, "4 5 6", "4 1e999 6"), ":13");
  add("FloatOverflow", pcd, replaced(a, "4 5 6", "4 1e60 6"), ":13");
  add("FarAway", pcd, replaced(a, "4 5 6", "4 1e12 6"));
  add("OnlyNan", pcd, pcdHeader("ascii") + "nan nan nan 0\nnan nan nan 0\nnan nan nan 0\n");
  add("OnlyInfinity", pcd, pcdHeader("ascii") + "inf 1 1 0\n1 -inf 1 0\n1 1 inf 0\n");
  add("BlankLineInside", pcd, replaced(a, "4 5 6 20\n", "\n4 5 6 20\n"), ":13");
  add("BinaryTooShort", pcd, b.substr(0, b.size() - 1), ", byte");
  add("BinaryTooLong", pcd, b + '\0', ", byte");
  add("CompressedTooShort", pcd, c.substr(0, c.size() - 1), ", byte");
  add("CompressedTooLong", pcd, c + '\0', ", byte");
  const std::string squeezed = c.substr(pcdHeader("binary_compressed").size() + 8);
  add("CompressedWrongSize", pcd,
      pcdHeader("binary_compressed") + packed(std::uint32_t(squeezed.size()), std::uint32_t(47)) + squeezed);
  add("CompressedHugeSize", pcd,
      pcdHeader("binary_compressed") + packed(std::uint32_t(squeezed.size()), std::uint32_t(0xfffffff0)) +
          squeezed);
  add("CompressedDamaged", pcd,
      pcdHeader("binary_compressed") + packed(std::uint32_t(squeezed.size()), std::uint32_t(48)) +
          "\xff\xff\xff" + squeezed.substr(3));
  add("AsciiCalledBinary", pcd, replaced(a, "DATA ascii", "DATA binary"), ", byte");
  // Exactly as long as three binary points.
  add("AsciiCalledBinaryOfTheRightLength", pcd,
      pcdHeader("binary") + "1.0 2.0 3.00 10\n4.0 5.0 6.00 20\n7.0 8.0 9.50 30\n");
  add("AsciiCalledCompressed", pcd, replaced(a, "DATA ascii", "DATA binary_compressed"));
  add("BinaryCalledAscii", pcd, replaced(b, "DATA binary", "DATA ascii"));
  add("UnknownData", pcd, replaced(a, "DATA ascii", "DATA zipped"), ":11");
  add("WrongPoints", pcd, replaced(a, "POINTS 3", "POINTS 4"));
  add("WrongWidth", pcd, replaced(a, "WIDTH 3", "WIDTH 2"));
  add("WrongBoth", pcd, replaced(replaced(a, "WIDTH 3", "WIDTH 4"), "POINTS 3", "POINTS 4"));
  add("ZeroPoints", pcd, replaced(replaced(a, "WIDTH 3", "WIDTH 0"), "POINTS 3", "POINTS 0"), ":7");
  add("NegativePoints", pcd, replaced(replaced(a, "WIDTH 3", "WIDTH -3"), "POINTS 3", "POINTS -3"), ":7");
  add("HugePoints", pcd,
      replaced(replaced(a, "WIDTH 3", "WIDTH 1000000000000"), "POINTS 3", "POINTS 1000000000000"), ":7");
  add("OverflowingPoints", pcd, replaced(a, "POINTS 3", "POINTS 99999999999999999999999"), ":10");
  add("NearlyHugePoints", pcd,
      replaced(replaced(a, "WIDTH 3", "WIDTH 99999999"), "POINTS 3", "POINTS 99999999"));
  add("NearlyHugeBinary", pcd,
      replaced(replaced(b, "WIDTH 3", "WIDTH 99999999"), "POINTS 3", "POINTS 99999999"));
  add("OverflowingProduct", pcd, replaced(replaced(a, "WIDTH 3", "WIDTH 65536"), "HEIGHT 1", "HEIGHT 65536"));
  add("WordForCount", pcd, replaced(a, "WIDTH 3", "WIDTH three"), ":7");
  add("BrokenCount", pcd, replaced(a, "WIDTH 3", "WIDTH 3.5"), ":7");
  add("NoZ", pcd, replaced(a, "FIELDS x y z intensity", "FIELDS x y w intensity"));
  add("FieldTwice", pcd, replaced(a, "FIELDS x y z intensity", "FIELDS x y z x"), ":3");
  add("SizeZero", pcd, replaced(a, "SIZE 4 4 4 4", "SIZE 4 4 4 0"), ":4");
  add("SizeOdd", pcd, replaced(a, "SIZE 4 4 4 4", "SIZE 4 4 4 3"));
  add("SizeNegative", pcd, replaced(a, "SIZE 4 4 4 4", "SIZE 4 4 4 -4"), ":4");
  add("SizeMissing", pcd, replaced(a, "SIZE 4 4 4 4\n", ""));
  add("SizesTooFew", pcd, replaced(a, "SIZE 4 4 4 4", "SIZE 4 4 4"), ":4");
  add("TypeUnknown", pcd, replaced(a, "TYPE F F F F", "TYPE F F F Q"), ":5");
  add("TypeWhole", pcd, replaced(a, "TYPE F F F F", "TYPE I F F F"));
  add("CountNegative", pcd, replaced(a, "COUNT 1 1 1 1", "COUNT 1 1 1 -1"), ":6");
  add("CountHuge", pcd, replaced(a, "COUNT 1 1 1 1", "COUNT 1 1 1 1000000000"), ":6");
  add("CountOfX", pcd, replaced(a, "COUNT 1 1 1 1", "COUNT 2 1 1 1"));
  add("UnknownEntry", pcd, replaced(a, "HEIGHT 1", "DEPTH 1"), ":8");
  add("EntryTwice", pcd, replaced(a, "HEIGHT 1", "WIDTH 3"), ":8");
  add("SizeBeforeFields", pcd,
      replaced(replaced(a, "FIELDS x y z intensity\n", ""), "TYPE", "FIELDS x y z intensity\nTYPE"));
  add("ViewpointShort", pcd, replaced(a, "0 0 0 1 0 0 0", "0 0 0 1 0 0"), ":9");
  add("ViewpointNan", pcd, replaced(a, "0 0 0 1 0 0 0", "nan 0 0 1 0 0 0"), ":9");
  add("ViewpointZero", pcd, replaced(a, "0 0 0 1 0 0 0", "0 0 0 0 0 0 0"), ":9");
  add("ByteOutOfRange", pcd,
      replaced(replaced(replaced(a, "SIZE 4 4 4 4", "SIZE 4 4 4 1"), "TYPE F F F F", "TYPE F F F U"), " 30",
               " 300"),
      ":14");

  const ScanFormat ply = ScanFormat::Ply;
  const std::string p = asciiPly(), pl = littlePly(), pb = bigPly();
  add("HeaderOnly", ply, plyHeader("ascii"));
  add("HeaderOnlyBinary", ply, plyHeader("binary_little_endian"));
  add("HeaderCut", ply, p.substr(0, 90));
  add("TooShort", ply, replaced(p, "3 0 1 2\n", ""));
  add("TooLong", ply, p + "1\n");
  add("LittleTooShort", ply, pl.substr(0, pl.size() - 1), ", byte");
  add("LittleTooLong", ply, pl + "x", ", byte");
  add("BigTooShort", ply, pb.substr(0, pb.size() - 1), ", byte");
  add("BigTooLong", ply, pb + "x", ", byte");
  add("BigCalledLittle", ply, replaced(pb, "big", "little"));
  add("AsciiCalledBinary", ply, replaced(p, "ascii", "binary_little_endian"), ", byte");
  add("BinaryCalledAscii", ply, replaced(pl, "binary_little_endian", "ascii"));
  add("WordForNumber", ply, replaced(p, "4 5 6", "4 five 6"), ":13");
  add("TooFewWords", ply, replaced(p, "4 5 6 20", "4 5 6"), ":13");
  add("TooManyWords", ply, replaced(p, "4 5 6 20", "4 5 6 20 1"), ":13");
  add("ListTooLong", ply, replaced(p, "3 0 1 2", "9 0 1 2"), ":15");
  add("ListNegative", ply, replaced(p, "3 0 1 2", "-3 0 1 2"), ":15");
  add("ListBroken", ply, replaced(p, "3 0 1 2", "2.5 0 1 2"), ":15");
  add("ListNan", ply, replaced(p, "3 0 1 2", "nan 0 1 2"), ":15");
  add("ListHuge", ply, replaced(p, "3 0 1 2", "1e15 0 1 2"), ":15");
  add("HugeCount", ply, replaced(p, "vertex 3", "vertex 1000000000000"));
  add("NearlyHugeCount", ply, replaced(p, "vertex 3", "vertex 99999999"));
  add("NearlyHugeBinary", ply, replaced(pl, "vertex 3", "vertex 99999999"));
  add("HugeOther", ply, replaced(p, "face 1", "face 4000000000000000000"));
  add("NegativeCount", ply, replaced(p, "vertex 3", "vertex -3"), ":4");
  add("ZeroCount", ply, replaced(p, "vertex 3", "vertex 0"));
  add("WordForCount", ply, replaced(p, "vertex 3", "vertex three"), ":4");
  add("NoVertex", ply, replaced(p, "element vertex", "element corner"));
  add("NoZ", ply, replaced(p, "float z", "float w"));
  add("WholeNumbered", ply, replaced(p, "float x", "int x"));
  add("UnknownType", ply, replaced(p, "float x", "half x"), ":5");
  add("PropertyTwice", ply, replaced(p, "float y", "float x"), ":6");
  add("ElementTwice", ply, replaced(p, "element face", "element vertex"), ":9");
  add("NoProperties", ply, "ply\nformat ascii 1.0\nelement vertex 3\nend_header\n1\n2\n3\n");
  add("PropertyFirst", ply, "ply\nformat ascii 1.0\nproperty float x\nelement vertex 1\nend_header\n1\n",
      ":3");
  add("NoFormat", ply, replaced(p, "format ascii 1.0\n", ""));
  add("UnknownFormat", ply, replaced(p, "ascii 1.0", "ascii 2.0"), ":2");
  add("NoMagic", ply, p.substr(4));
  add("ListOfFloats", ply, replaced(p, "list uchar int", "list float int"), ":10");
  add("OnlyNan", ply,
      replaced(replaced(replaced(p, "1 2 3", "nan 2 3"), "4 5 6", "nan 5 6"), "7 8", "nan 8"));

  add("OnlyInfinity", ply,
      replaced(replaced(replaced(p, "1 2 3", "inf 2 3"), "4 5 6", "4 -inf 6"), "7 8", "inf 8"));
  add("WrongCount", ply, replaced(p, "vertex 3", "vertex 2"));
  add("WrongCountBinary", ply, replaced(pl, "vertex 3", "vertex 2"), ", byte");
  add("CutInsideAPoint", ply, p.substr(0, p.find("8 9.5")), ":14");

  const ScanFormat ptx_format = ScanFormat::Ptx;
  const std::string x = ptx();
  add("HeaderOnly", ptx_format, ptxHeader());
  add("HeaderCut", ptx_format, x.substr(0, 25));
  add("TooShort", ptx_format, replaced(x, "3 2 4.5 0.6\n", ""));
  add("TooLong", ptx_format, x + "1 1 1 1\n");
  add("SecondScanCut", ptx_format, x + x.substr(0, x.size() - 12));
  add("WordForNumber", ptx_format, replaced(x, "2 2 3 0.3", "2 two 3 0.3"), ":13");
  add("TooFewWords", ptx_format, replaced(x, "2 2 3 0.3", "2 2 3"), ":13");
  add("TooManyWords", ptx_format, replaced(x, "2 2 3 0.3", "2 2 3 0.3 1 2 3 4"), ":13");
  add("ZeroColumns", ptx_format, "0" + x.substr(1));
  add("NegativeColumns", ptx_format, "-" + x);
  add("HugeColumns", ptx_format, "1000000000000" + x.substr(1));
  add("NearlyHugeColumns", ptx_format, "49999999" + x.substr(1));
  add("OverflowingProduct", ptx_format, "99999999\n99999999" + x.substr(3));
  add("WrongCounts", ptx_format, "4" + x.substr(1));
  add("MatrixNan", ptx_format, replaced(x, "1 0 0 0\n", "nan 0 0 0\n"), ":7");
  add("MatrixScaled", ptx_format, replaced(x, "1 0 0 0\n", "2 0 0 0\n"), ":10");
  add("MatrixMirrored", ptx_format, replaced(x, "1 0 0 0\n", "-1 0 0 0\n"), ":10");
  add("MatrixZero", ptx_format, replaced(x, "1 2 3 1\n", "1 2 3 0\n"), ":10");
  add("OnlyEmptyCells", ptx_format,
      ptxHeader() + "0 0 0 0.5\n0 0 0 0.5\n0 0 0 0.5\n0 0 0 0.5\n0 0 0 0.5\n0 0 0 0.5\n");

  add("OnlyNan", ptx_format,
      ptxHeader() + "nan 1 1 0.5\n1 nan 1 0.5\n1 1 nan 0.5\n0 0 0 0.5\n0 0 0 0.5\n0 0 0 0.5\n");
  add("OnlyInfinity", ptx_format,
      ptxHeader() + "inf 1 1 0.5\n1 -inf 1 0.5\n1 1 inf 0.5\n0 0 0 0.5\n0 0 0 0.5\n0 0 0 0.5\n");
  add("WordForCount", ptx_format, "three" + x.substr(1), ":1");
  add("BrokenCount", ptx_format, "3.5" + x.substr(1), ":1");
  add("FarAway", ptx_format, replaced(x, "2 2 3 0.3", "2 1e12 3 0.3"));

  const ScanFormat vtk = ScanFormat::Vtk;
  const std::string v = asciiVtk(), vb = binaryVtk();
  add("HeaderOnly", vtk, vtkHeader("ASCII"));
  add("HeaderOnlyBinary", vtk, vtkHeader("BINARY"));
  add("HeaderCut", vtk, v.substr(0, 50));
  add("TooShort", vtk, replaced(v, "30\n", ""), ", byte");
  add("TooLong", vtk, v + "40\n", ", byte");
  add("BinaryTooShort", vtk, vb.substr(0, vb.size() - 3), ", byte");
  const std::string only_points =
      vtkHeader("BINARY") + packedBigEndian(1.F, 2.F, 3.F, 4.F, 5.F, 6.F, 7.F, 8.F, 9.5F);
  add("BinaryOneByteShort", vtk, only_points.substr(0, only_points.size() - 1));
  add("BinaryTooLong", vtk, vb + "abc", ", byte");
  add("AsciiCalledBinary", vtk, replaced(v, "ASCII", "BINARY"));
  add("BinaryCalledAscii", vtk, replaced(vb, "BINARY", "ASCII"));
  add("NeitherKind", vtk, replaced(v, "ASCII", "TEXT"));
  add("WordForNumber", vtk, replaced(v, "4 5 6", "4 five 6"), ", byte");
  add("HugeCount", vtk, replaced(v, "POINTS 3", "POINTS 1000000000000"));
  add("NearlyHugeCount", vtk, replaced(v, "POINTS 3", "POINTS 99999999"));
  add("NearlyHugeBinary", vtk, replaced(vb, "POINTS 3", "POINTS 99999999"));
  add("NegativeCount", vtk, replaced(v, "POINTS 3", "POINTS -3"));
  add("ZeroCount", vtk, replaced(v, "POINTS 3", "POINTS 0"));
  add("WrongCount", vtk, replaced(v, "POINTS 3", "POINTS 2"));
  add("HugeVertices", vtk, replaced(v, "VERTICES 3 6", "VERTICES 3 999999999999"));
  add("WrongAttributes", vtk, replaced(v, "POINT_DATA 3", "POINT_DATA 4"));
  add("UnknownType", vtk, replaced(v, "POINTS 3 float", "POINTS 3 half"));
  add("WholeNumbered", vtk, replaced(v, "POINTS 3 float", "POINTS 3 int"));
  add("UnknownSection", vtk, replaced(v, "VERTICES", "EDGES"));
  add("OtherDataSet", vtk, replaced(v, "POLYDATA", "STRUCTURED_POINTS"));
  add("NoPoints", vtk, "# vtk DataFile Version 3.0\nt\nASCII\nDATASET POLYDATA\n");
  add("PointsTwice", vtk, v + "POINTS 3 float\n1 2 3 4 5 6 7 8 9\n");
  add("HugeField", vtk, v + "FIELD f 999999999999\n");
  add("HugeComponents", vtk, v + "FIELD f 1\na 99999999999 99999999999 float\n");

  add("OnlyNan", vtk, replaced(replaced(v, "1 2 3 4 5 6", "nan 2 3 4 nan 6"), "7 8 9.5", "7 8 nan"));
  add("OnlyInfinity", vtk, replaced(replaced(v, "1 2 3 4 5 6", "inf 2 3 4 -inf 6"), "7 8 9.5", "7 8 inf"));
  add("WordForCount", vtk, replaced(v, "POINTS 3", "POINTS three"));
  add("FarAway", vtk, replaced(v, "4 5 6", "4 1e12 6"));

  const ScanFormat uos_format = ScanFormat::Uos;
  const std::string u = uos();
  add("CountOnly", uos_format, "3\n");
  add("TooShort", uos_format, replaced(u, "700 950 800 30\n", ""));
  add("TooLong", uos_format, u + "1 1 1 1\n");
  add("LineCut", uos_format, u.substr(0, u.size() - 4), ":4");
  add("WordForNumber", uos_format, replaced(u, "400 600", "400 six"), ":3");
  add("TooManyWords", uos_format, replaced(u, "400 600 500 20", "400 600 500 20 5"), ":3");
  add("FiveWords", uos_format, "1 2 3 4 5\n", ":1");
  add("NegativeCount", uos_format, "-" + u, ":1");
  add("ZeroCount", uos_format, "0" + u.substr(1), ":1");
  add("HugeCount", uos_format, "1000000000000" + u.substr(1), ":1");
  add("WrongCounts", uos_format, "3 2" + u.substr(1));
  add("OverflowingCounts", uos_format, "99999999 99999999" + u.substr(1));
  add("Overflow", uos_format, replaced(u, "400 600", "400 1e999"), ":3");
  add("FarAway", uos_format, replaced(u, "400 600", "400 1e200"));
  add("OnlyNan", uos_format, "nan nan nan\n");
  add("OnlyInfinity", uos_format, "inf 1 1\n1 -inf 1\n");
  add("OnlyOrigin", uos_format, "0 0 0\n0 0 0\n");

  const ScanFormat xyz_format = ScanFormat::Xyz;
  const std::string t = xyz(), s = csv();
  add("CountOnly", xyz_format, "3\n");
  add("CommentOnly", xyz_format, "# nothing\n// here\n");
  add("NamesOnly", xyz_format, "x,y,z\n");
  add("TooShort", xyz_format, replaced(t, "7 8 9.5 30\n", ""));
  add("TooLong", xyz_format, t + "1 1 1 1\n");
  add("WordForNumber", xyz_format, replaced(t, "4 5 6", "4 five 6"), ":3");
  add("TooFewWords", xyz_format, replaced(t, "4 5 6 20", "4 5 6"), ":3");
  add("TooManyWords", xyz_format, replaced(t, "4 5 6 20", "4 5 6 20 1"), ":3");
  add("TwoColumns", xyz_format, "1 2\n3 4\n", ":1");
  add(
      "ManyColumns", xyz_format, std::string(200, '1') + "\n" + [] {
        std::string line;
        for (int i = 0; i < 100; ++i) line += "1 ";
        return line;
      }());
  add("UnknownNames", xyz_format, "east,north,up\n1,2,3\n", ":1");
  add("CsvShortLine", xyz_format, replaced(s, "5,4,6,20,7", "5,4,6,20"), ":3");
  add("CsvEmptyCell", xyz_format, replaced(s, "5,4,6,20,7", "5,,6,20,7"), ":3");
  add("CsvWord", xyz_format, replaced(s, "5,4,6,20,7", "5,four,6,20,7"), ":3");
  add("OtherSeparator", xyz_format, replaced(s, "5,4,6,20,7", "5;4;6;20;7"), ":3");
  add("HugeCount", xyz_format, "1000000000000" + t.substr(1), ":1");
  add("NegativeCount", xyz_format, "-3" + t.substr(1), ":1");
  add("OnlyNan", xyz_format, "nan nan nan\n");
  add("OnlyInfinity", xyz_format, "inf 1 1\n1 -inf 1\n1 1 inf\n");
  add("CsvOnlyNan", xyz_format, "x,y,z\nnan,1,1\n");
  add("FarAway", xyz_format, replaced(t, "4 5 6", "4 1e12 6"));
  add("BinaryAfterTheFirstLine", xyz_format, "1 2 3\n" + noise(300, 2), ":2");
  return list;
}

class BadInput : public testing::TestWithParam<BadFile> {};

TEST_P(BadInput, IsRefusedWithTheNameOfTheFile) {
  const TemporaryFolder folder;
  expectRefused(folder.write("the_file.dat", GetParam().bytes), GetParam().format, GetParam().where);
  EXPECT_EQ(folder.entries(), 1U);
}

INSTANTIATE_TEST_SUITE_P(Table, BadInput, testing::ValuesIn(badFiles()),
                         [](const auto& test) { return test.param.name; });

struct WholeFile {
  const char* name;
  ScanFormat format;
  std::string bytes;
  bool exact;  // its header tells how long it is: cut anywhere it is malformed
};

std::vector<WholeFile> wholeFiles() {
  return {{"AsciiPcd", ScanFormat::Pcd, asciiPcd(), true},
          {"BinaryPcd", ScanFormat::Pcd, binaryPcd(), true},
          {"CompressedPcd", ScanFormat::Pcd, compressedPcd(), true},
          {"AsciiPly", ScanFormat::Ply, asciiPly(), true},
          {"LittlePly", ScanFormat::Ply, littlePly(), true},
          {"BigPly", ScanFormat::Ply, bigPly(), true},
          {"Ptx", ScanFormat::Ptx, ptx(), true},
          {"AsciiVtk", ScanFormat::Vtk, asciiVtk(), false},
          {"BinaryVtk", ScanFormat::Vtk, binaryVtk(), false},
          {"Uos", ScanFormat::Uos, uos(), true},
          {"Xyz", ScanFormat::Xyz, xyz(), true},
          {"Csv", ScanFormat::Xyz, csv(), false}};
}

void PrintTo(const WholeFile& file, std::ostream* out) {
  *out << file.name;
}

class Broken : public testing::TestWithParam<WholeFile> {};

// So that the tables above break what would have been read.
TEST_P(Broken, TheWholeFileIsRead) {
  const TemporaryFolder folder;
  const auto result = readScans(folder.write("whole.dat", GetParam().bytes), {GetParam().format, 0.0, 0.0});
  ASSERT_TRUE(result) << result.error().what << " " << result.error().where;
  ASSERT_EQ(result->scans.size(), 1U);
  const Scan& scan = result->scans[0].scan;
  EXPECT_TRUE(scan.image->hasIntensity());
  if (GetParam().format == ScanFormat::Ptx) return;
  ASSERT_EQ(scan.image->validCells(), 3U);
  const auto points = cellPoints(*scan.image, scan.geometry);
  EXPECT_LT((points[0] - Eigen::Vector3d(1, 2, 3)).norm(), 1e-6);
  EXPECT_LT((points[2] - Eigen::Vector3d(7, 8, 9.5)).norm(), 1e-6);
  EXPECT_FLOAT_EQ(scan.image->intensity(1), 20.0F);
}

class TextFile : public testing::TestWithParam<WholeFile> {};

TEST_P(TextFile, CarriageReturnsBeforeSomeLineEndsAreFine) {
  std::string bytes;
  int line = 0;
  for (const char c : GetParam().bytes) {
    if (c == '\n' && ++line % 2 == 0) bytes += '\r';
    bytes += c;
  }
  const TemporaryFolder folder;
  const auto result = readScans(folder.write("mixed.dat", bytes), {GetParam().format, 0.0, 0.0});
  EXPECT_TRUE(result) << result.error().what << " " << result.error().where;
}

// NaN and infinity stand for a cell without a point; the others are kept.
TEST_P(TextFile, APointThatIsNotFiniteIsNoPoint) {
  const std::string bytes = GetParam().bytes;
  const bool centimetres = GetParam().format == ScanFormat::Uos,
             ptx_file = GetParam().format == ScanFormat::Ptx;
  std::string from = centimetres ? "400 600 500" : ptx_file ? "2 2 3 0.3" : "4 5 6";
  if (GetParam().name == std::string("Csv")) from = "5,4,6";
  for (const std::string word : {"nan", "inf", "-inf"}) {
    std::string to = from;
    to.replace(0, to.find_first_of(" ,"), word);
    const TemporaryFolder folder;
    const auto result =
        readScans(folder.write("one.dat", replaced(bytes, from, to)), {GetParam().format, 0.0, 0.0});
    ASSERT_TRUE(result) << word << ": " << result.error().what << " " << result.error().where;
    EXPECT_EQ(result->scans[0].scan.image->validCells(), ptx_file ? 4U : 2U) << word;
  }
}

TEST_P(Broken, CutAnywhereItIsRefused) {
  const TemporaryFolder folder;
  for (std::size_t length = 1; length < GetParam().bytes.size(); ++length) {
    const auto path = folder.write("cut.dat", GetParam().bytes.substr(0, length));
    const auto result = readScans(path, {GetParam().format, 0.0, 0.0});
    // Without the last digit or line end of a text, all its numbers are still there.
    const bool complete =
        length + 3 >= GetParam().bytes.size() && GetParam().bytes.find('\0') == std::string::npos;
    if (GetParam().exact && !complete) {
      EXPECT_FALSE(result) << length;
    }
    if (!result) {
      EXPECT_NE(result.error().where.find("cut.dat"), std::string::npos);
    }
  }
}

TEST_P(Broken, WithAnyByteChangedItIsReadOrRefusedButNothingElse) {
  RandomStream random(5);
  const TemporaryFolder folder;
  for (int round = 0; round < 300; ++round) {
    std::string bytes = GetParam().bytes;
    for (std::uint64_t k = 0; k <= random.below(3); ++k)
      bytes[random.below(bytes.size())] =
          static_cast<char>(random.below(2) ? random.below(256) : '0' + random.below(10));
    const auto result = readScans(folder.write("changed.dat", bytes), {GetParam().format, 0.0, 0.0});
    if (!result) {
      EXPECT_NE(result.error().where.find("changed.dat"), std::string::npos);
      continue;
    }
    for (const ImportedScan& imported : result->scans) {
      EXPECT_GT(imported.scan.image->validCells(), 0U);
      EXPECT_TRUE(imported.scan.geometry.check());
      for (const Eigen::Vector3d& p : cellPoints(*imported.scan.image, imported.scan.geometry))
        EXPECT_TRUE(p.allFinite());
    }
  }
}

std::vector<WholeFile> textFiles() {
  std::vector<WholeFile> files = wholeFiles();
  std::erase_if(files, [](const WholeFile& file) { return file.bytes.find('\0') != std::string::npos; });
  return files;
}

INSTANTIATE_TEST_SUITE_P(Whole, TextFile, testing::ValuesIn(textFiles()),
                         [](const auto& test) { return test.param.name; });
INSTANTIATE_TEST_SUITE_P(Whole, Broken, testing::ValuesIn(wholeFiles()),
                         [](const auto& test) { return test.param.name; });

TEST(BadPath, MissingFileFolderAndDeviceAreErrors) {
  const TemporaryFolder folder;
  expectRefused(folder / "none.pcd", ScanFormat::Auto, "");
  expectRefused(folder.path(), ScanFormat::Auto, "");
  expectRefused("/dev/zero", ScanFormat::Xyz, "");
}

TEST(BadPath, AFileThatMayNotBeReadIsAnError) {
  const TemporaryFolder folder;
  const auto locked = folder.write("locked.pcd", asciiPcd());
  std::filesystem::permissions(locked, std::filesystem::perms::none);
  ChildProcess child([&](const ChildProcess::Say& say) {
    giveUpRootsRights();
    const auto result = readScans(locked, {});
    say(result ? "read" : result.error().where + " -> " + result.error().remedy);
  });
  const std::string said = child.rest();
  EXPECT_NE(said.find("locked.pcd -> "), std::string::npos) << said;
}

TEST(HugeCounts, MakeNoRoom) {
  const auto peak = [] {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return usage.ru_maxrss;  // KiB
  };
  const long before = peak();
  const TemporaryFolder folder;
  for (const BadFile& bad : badFiles()) {
    if (bad.name.find("Huge") == std::string::npos) continue;
    EXPECT_FALSE(readScans(folder.write("huge.dat", bad.bytes), {bad.format, 0.0, 0.0})) << bad.name;
  }
  EXPECT_LT(peak() - before, 100 * 1024) << "a hundred million points would take gigabytes";
}

}  // namespace
}  // namespace tiltmap
