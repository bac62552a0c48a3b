// The header of a PCD file, checked.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/result.h"
#include "core/geometry/pose.h"
#include "core/io/point_table.h"

namespace tiltmap {

enum class PcdBody { Ascii, Binary, Compressed };

struct PcdField {
  std::string name;
  int size = 0;
  char type = 'F';
  long long count = 1;
};

struct PcdHeader {
  std::vector<PcdField> fields;
  long long width = -1, height = -1, points = -1;
  std::optional<Pose> viewpoint;
  PcdBody body = PcdBody::Ascii;
  std::size_t body_at = 0;       // byte
  std::size_t header_lines = 0;  // lines up to and with DATA

  std::size_t pointBytes() const {
    std::size_t sum = 0;
    for (const PcdField& field : fields)
      sum += static_cast<std::size_t>(field.size) * static_cast<std::size_t>(field.count);
    return sum;
  }
  std::size_t pointWords() const {
    std::size_t sum = 0;
    for (const PcdField& field : fields) sum += static_cast<std::size_t>(field.count);
    return sum;
  }
};

// Refuses unknown, doubled and missing lines, counts that are not from 1 to 100 million or contradict each
// other, and fields without floating point x, y and z. Says nothing about the length of what follows.
Result<PcdHeader> parsePcdHeader(std::string_view bytes, const ParseContext& context);

// The header again, in the one spelling that PCL and we cannot read in two ways; without the viewpoint.
std::string plainPcdHeader(const PcdHeader& header);

}  // namespace tiltmap
