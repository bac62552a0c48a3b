// Two scans of a project as a registration wants them, made once by whichever thread asks first.
#pragma once

#include <memory>
#include <mutex>
#include <optional>

#include "core/project/project_snapshot.h"
#include "core/registration/prepared_scan.h"

namespace tiltmap::ui {

class PreparedPair {
 public:
  struct Scans {
    PreparedScanPtr fixed, moving;
  };

  // The settings must have passed checkSettings.
  PreparedPair(ScanEntry fixed, ScanEntry moving, RegistrationSettings settings)
      : fixed_(std::move(fixed)), moving_(std::move(moving)), settings_(settings) {}

  const RegistrationSettings& settings() const { return settings_; }
  const ScanEntry& fixed() const { return fixed_; }
  const ScanEntry& moving() const { return moving_; }

  // Any thread; the others wait. Error: a matrix cannot be read.
  Result<Scans> get() {
    const std::lock_guard lock(mutex_);
    if (!scans_) scans_ = make();
    return *scans_;
  }

 private:
  Result<Scans> make() const {
    const auto fixed = fixed_.scan();
    if (!fixed) return fail(fixed.error());
    const auto moving = moving_.scan();
    if (!moving) return fail(moving.error());
    return Scans{prepare(*fixed, settings_), prepare(*moving, settings_)};
  }

  ScanEntry fixed_, moving_;
  RegistrationSettings settings_;
  std::mutex mutex_;
  std::optional<Result<Scans>> scans_;
};
using PreparedPairPtr = std::shared_ptr<PreparedPair>;

}  // namespace tiltmap::ui
