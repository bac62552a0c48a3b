#include "core/io/cloud_stream.h"

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <stdexcept>

static_assert(std::endian::native == std::endian::little,
              "the binary writers assume a little-endian machine");

namespace tiltmap {

namespace {

std::uint8_t channel(double value) {
  return static_cast<std::uint8_t>(std::lround(255.0 * std::clamp(value, 0.0, 1.0)));
}

// Hue in turns, full saturation and the given brightness.
Rgb hue(double turns, double brightness) {
  const double h = 6.0 * (turns - std::floor(turns));
  const auto part = [&](double centre) {
    const double away = std::abs(std::remainder(h - centre, 6.0));
    return channel(brightness * (2.0 - away));
  };
  return {part(0.0), part(2.0), part(4.0)};
}

// At most this many values a scan decide the ends of a colour scale.
constexpr std::size_t kSamplesPerScan = 2000;

}  // namespace

PointCloud exportedCloud(const ExportScan& scan) {
  if (!scan.cloud.empty() || !scan.image) return scan.cloud;
  return cloudOf(*scan.image, scan.geometry);
}

Result<ColourScale> colourScale(const CloudForExport& cloud, CloudColour colour, const JobControl& control) {
  std::vector<double> samples;
  if (colour != CloudColour::Height && colour != CloudColour::Intensity) return ColourScale();
  for (std::size_t i = 0; i < cloud.scans; ++i) {
    if (control.stopRequested()) return fail(kCancelled, "export", "start again when you like");
    const auto scan = cloud.scan(i);
    if (!scan) return fail(scan.error());
    const PointCloud points = exportedCloud(*scan);
    const std::size_t stride = std::max<std::size_t>(1, points.size() / kSamplesPerScan);
    for (std::size_t k = 0; k < points.size(); k += stride) {
      if (colour == CloudColour::Height)
        samples.push_back((scan->world_from_scan * points.points[k]).z());
      else if (!points.intensity.empty())
        samples.push_back(static_cast<double>(points.intensity[k]));
    }
  }
  std::erase_if(samples, [](double v) { return !std::isfinite(v); });
  if (samples.empty()) return ColourScale();
  std::ranges::sort(samples);
  return ColourScale{samples[samples.size() / 100], samples[samples.size() - 1 - samples.size() / 100]};
}

Rgb PointColours::of(const Eigen::Vector3d& in_world, float intensity, const ExportScan& scan) const {
  const auto along = [this](double value) {
    const double span = scale_.high - scale_.low;
    return span > 0.0 ? std::clamp((value - scale_.low) / span, 0.0, 1.0) : 0.5;
  };
  switch (colour_) {
    case CloudColour::None:
      break;
    // Steps of the golden ratio keep the hues of neighbouring scans apart.
    case CloudColour::Scan:
      return scan.colour ? *scan.colour : hue(0.61803398874989485 * scan.index, 0.9);
    case CloudColour::Height:
      return hue((1.0 - along(in_world.z())) * 2.0 / 3.0, 1.0);
    case CloudColour::Intensity: {
      const std::uint8_t grey = channel(along(static_cast<double>(intensity)));
      return {grey, grey, grey};
    }
  }
  return {};
}

float packedColour(const Rgb& colour) {
  const std::uint32_t word = (std::uint32_t{colour[0]} << 16) | (std::uint32_t{colour[1]} << 8) | colour[2];
  float value = 0.0F;
  std::memcpy(&value, &word, sizeof(value));
  return value;
}

Result<CloudStream> CloudStream::prepare(const CloudForExport& source, const WriteOptions& options,
                                         const PointColours& colours, const std::string& file,
                                         const JobControl& control) {
  CloudStream stream(source, colours, file, control);
  stream.layout_.normals = source.normals;
  stream.layout_.intensity = source.intensity;
  stream.layout_.colour = colours.any();
  stream.layout_.doubles = options.double_precision;
  if (auto counted = stream.count(); !counted) return fail(counted.error());
  return stream;
}

Status CloudStream::count() {
  for (std::size_t i = 0; i < source_.scans; ++i) {
    if (control_.stopRequested()) return fail(cancelled());
    auto scan = source_.scan(i);
    if (!scan) return fail(scan.error());
    layout_.points += scan->cloud.empty() && scan->image ? scan->image->validCells() : scan->cloud.size();
  }
  if (layout_.points == 0)
    return fail("there are no points to write", file_, "choose scans that hold points");
  return {};
}

Error CloudStream::cancelled() const {
  return {kCancelled, file_, "start again when you like"};
}

Status CloudStream::forEach(const std::ostream& out,
                            const std::function<void(const ExportPoint&)>& use) const {
  std::size_t written = 0;
  ExportPoint point;
  for (std::size_t i = 0; i < source_.scans; ++i) {
    control_.tell(static_cast<double>(written) / static_cast<double>(layout_.points),
                  "writing scan " + std::to_string(i + 1) + " of " + std::to_string(source_.scans));
    auto scan = source_.scan(i);
    if (!scan) return fail(scan.error());
    const PointCloud cloud = exportedCloud(*scan);
    const Eigen::Matrix3d rotation = scan->world_from_scan.rotation();
    point.scan = scan->index;
    for (std::size_t k = 0; k < cloud.size(); ++k, ++written) {
      if ((k & 8191U) == 0 && control_.stopRequested()) return fail(cancelled());
      if ((k & 8191U) == 0 && !out) return {};  // whoever owns the file knows why
      point.position = rotation * cloud.points[k] + scan->world_from_scan.translation();
      point.normal =
          cloud.hasNormal(k) ? Eigen::Vector3d(rotation * cloud.normals[k]) : Eigen::Vector3d::Zero();
      point.intensity = cloud.intensity.empty() ? 0.0F : cloud.intensity[k];
      if (colours_.any()) point.colour = colours_.of(point.position, point.intensity, *scan);
      use(point);
    }
  }
  if (written != layout_.points)
    return fail("the scans changed while they were written", file_, "write them again");
  return {};
}

Status CloudStream::forIndices(const std::ostream& out, const std::function<void(std::size_t)>& use) const {
  for (std::size_t i = 0; i < layout_.points; ++i) {
    if ((i & 8191U) == 0 && control_.stopRequested()) return fail(cancelled());
    if ((i & 8191U) == 0 && !out) return {};
    use(i);
  }
  return {};
}

void appendFixed(std::string& text, double value, int decimals) {
  std::array<char, 400> buffer;  // a double printed in full has 309 digits before the point
  const auto [end, error] =
      std::to_chars(buffer.data(), buffer.data() + buffer.size(), value, std::chars_format::fixed, decimals);
  if (error != std::errc()) throw std::logic_error("a number is too long to print");
  text.append(buffer.data(), end);
}

void appendShortest(std::string& text, float value) {
  std::array<char, 32> buffer;
  const auto result = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value);
  text.append(buffer.data(), result.ptr);
}

}  // namespace tiltmap
