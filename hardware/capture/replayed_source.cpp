#include "hardware/capture/replayed_source.h"

#include "hardware/transport/device_url.h"
#include "hardware/transport/session_log.h"

namespace tiltmap {

namespace {

Result<std::string> replayedUrl(const std::filesystem::path& file, const std::vector<DeviceScheme>& known,
                                const char* what) {
  if (file.empty())
    return fail(std::string("no recording of the ") + what + " is named", "",
                "choose the file that ?log= of its address wrote");
  const auto session = readSession(file);
  if (!session) return fail(session.error());
  auto url = parseDeviceUrl(session->about, known);
  if (!url)
    return fail(std::string("this is no recording of a ") + what, file.string(),
                "it was recorded from " + session->about);
  url->port = "replay:" + file.string();
  url->options.erase("log");
  return url->text();
}

}  // namespace

Result<CaptureSettings> replayedSource(const std::filesystem::path& scanner,
                                       const std::filesystem::path& tilt) {
  const auto scanner_url = replayedUrl(scanner, scannerSchemes(), "scanner");
  if (!scanner_url) return fail(scanner_url.error());
  const auto tilt_url = replayedUrl(tilt, tiltSchemes(), "tilt unit");
  if (!tilt_url) return fail(tilt_url.error());
  CaptureSettings settings;
  settings.scanner = *scanner_url;
  settings.tilt = *tilt_url;
  return settings;
}

}  // namespace tiltmap
