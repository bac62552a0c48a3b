// The smallest whole file of each kind, to be broken in every way.
#pragma once

#include <algorithm>
#include <cstdint>
#include <string>

namespace tiltmap::test {

template <class... T>
std::string packed(T... values) {
  std::string bytes;
  const auto add = [&](auto value) { bytes.append(reinterpret_cast<const char*>(&value), sizeof(value)); };
  (add(values), ...);
  return bytes;
}

template <class... T>
std::string packedBigEndian(T... values) {
  std::string bytes;
  const auto add = [&](auto value) {
    std::string one(reinterpret_cast<const char*>(&value), sizeof(value));
    std::reverse(one.begin(), one.end());
    bytes += one;
  };
  (add(values), ...);
  return bytes;
}

// Every occurrence of `from` becomes `to`; the test is broken where there is none.
inline std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  if (at == std::string::npos) throw std::logic_error("nothing to replace: " + from);
  return text.replace(at, from.size(), to);
}

inline std::string pcdHeader(const std::string& data) {
  return "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS x y z intensity\nSIZE 4 4 4 4\n"
         "TYPE F F F F\nCOUNT 1 1 1 1\nWIDTH 3\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 3\nDATA " +
         data + "\n";
}
inline std::string asciiPcd() {
  return pcdHeader("ascii") + "1 2 3 10\n4 5 6 20\n7 8 9.5 30\n";
}
inline std::string binaryPcd() {
  return pcdHeader("binary") + packed(1.F, 2.F, 3.F, 10.F, 4.F, 5.F, 6.F, 20.F, 7.F, 8.F, 9.5F, 30.F);
}
// Field by field; one literal run of 32 bytes and one of 16.
inline std::string compressedPcd() {
  const std::string body = packed(1.F, 4.F, 7.F, 2.F, 5.F, 8.F, 3.F, 6.F, 9.5F, 10.F, 20.F, 30.F);
  const std::string squeezed = "\x1f" + body.substr(0, 32) + "\x0f" + body.substr(32);
  return pcdHeader("binary_compressed") + packed(std::uint32_t(squeezed.size()), std::uint32_t(body.size())) +
         squeezed;
}
inline std::string plyHeader(const std::string& format) {
  return "ply\nformat " + format +
         " 1.0\ncomment made by hand\nelement vertex 3\nproperty float x\n"
         "property float y\nproperty float z\nproperty float intensity\nelement face 1\n"
         "property list uchar int vertex_indices\nend_header\n";
}
inline std::string asciiPly() {
  return plyHeader("ascii") + "1 2 3 10\n4 5 6 20\n7 8 9.5 30\n3 0 1 2\n";
}
inline std::string littlePly() {
  return plyHeader("binary_little_endian") +
         packed(1.F, 2.F, 3.F, 10.F, 4.F, 5.F, 6.F, 20.F, 7.F, 8.F, 9.5F, 30.F) + packed(std::uint8_t{3}) +
         packed(0, 1, 2);
}
inline std::string bigPly() {
  return plyHeader("binary_big_endian") +
         packedBigEndian(1.F, 2.F, 3.F, 10.F, 4.F, 5.F, 6.F, 20.F, 7.F, 8.F, 9.5F, 30.F) +
         packed(std::uint8_t{3}) + packedBigEndian(0, 1, 2);
}
inline std::string ptxHeader() {
  return "3\n2\n1 2 3\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n1 2 3 1\n";
}
inline std::string ptx() {
  return ptxHeader() + "1 2 3 0.1\n1 2 4 0.2\n2 2 3 0.3\n0 0 0 0.5\n3 2 3 0.5\n3 2 4.5 0.6\n";
}
inline std::string vtkHeader(const std::string& kind) {
  return "# vtk DataFile Version 3.0\ntitle\n" + kind + "\nDATASET POLYDATA\nPOINTS 3 float\n";
}
inline std::string asciiVtk() {
  return vtkHeader("ASCII") +
         "1 2 3 4 5 6\n7 8 9.5\nVERTICES 3 6\n1 0\n1 1\n1 2\n\nPOINT_DATA 3\nSCALARS intensity float 1\n"
         "LOOKUP_TABLE default\n10\n20\n30\n";
}
inline std::string binaryVtk() {
  return vtkHeader("BINARY") + packedBigEndian(1.F, 2.F, 3.F, 4.F, 5.F, 6.F, 7.F, 8.F, 9.5F) +
         "\nVERTICES 3 6\n" + packedBigEndian(1, 0, 1, 1, 1, 2) +
         "\nPOINT_DATA 3\nSCALARS intensity float 1\nLOOKUP_TABLE default\n" +
         packedBigEndian(10.F, 20.F, 30.F) + "\n";
}
inline std::string uos() {
  return "3\n100 300 200 10\n400 600 500 20\n700 950 800 30\n";
}
inline std::string xyz() {
  return "3\n1 2 3 10\n4 5 6 20\n7 8 9.5 30\n";
}
inline std::string csv() {
  return "y,x,z,intensity,label\n2,1,3,10,7\n5,4,6,20,7\n8,7,9.5,30,7\n";
}

}  // namespace tiltmap::test
