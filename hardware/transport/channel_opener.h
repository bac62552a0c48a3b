// Opens what a URL names, as often as a driver connects anew, and keeps one record of it all.
#pragma once

#include <memory>
#include <string>

#include "hardware/transport/device_url.h"
#include "hardware/transport/session_log.h"

namespace tiltmap {

class ReplayOpener;

// The port is looked for at each opening, so that one that came back under another name is found by its by-id
// name, its vendor or its serial number. With ?log=FILE all openings go into one session; "replay:FILE" gives
// its openings, failed ones too, in the same order.
class ChannelOpener {
 public:
  // `baud` is used where the URL names none. The clock must outlive the opener and its channels.
  ChannelOpener(DeviceUrl url, int baud, RealClock& clock);
  ~ChannelOpener();
  Result<std::unique_ptr<ByteChannel>> open();

 private:
  Result<std::unique_ptr<ByteChannel>> openPort(int baud);
  Result<std::unique_ptr<ByteChannel>> openNetwork();
  Result<std::unique_ptr<ByteChannel>> openReplay();
  DeviceUrl url_;
  int baud_;
  RealClock& clock_;
  std::shared_ptr<SessionLog> log_;
  std::unique_ptr<ReplayOpener> replay_;
};

}  // namespace tiltmap
