// One colour a scan, the same in every picture and view.
#pragma once

#include <cstddef>
#include <vector>

#include "core/products/colour.h"
#include "core/project/project_snapshot.h"

namespace tiltmap {

inline constexpr std::size_t kFixedScanColours = 12;

// The first twelve are a fixed list that the colour-blind can tell apart too; neighbours in it, which overlap
// on a map, differ most. From there on the hue turns by the golden angle, which never comes back near a
// recent one.
Rgb scanColour(std::size_t scan);
// The colour a person chose for the scan, else that of its place.
Rgb scanColour(const ScanEntry& scan, std::size_t index);
// Of every scan of a project, by index.
std::vector<Rgb> scanColours(const ProjectSnapshot& snapshot);

}  // namespace tiltmap
