// A serial port of the machine, through Qt's serial port module.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "hardware/transport/byte_channel.h"

namespace tiltmap {

// What is plugged in. Texts are empty where the system does not know them.
struct PortInfo {
  std::string path;           // "/dev/ttyUSB0"
  std::string by_id;          // "/dev/serial/by-id/usb-FTDI_...": stays the same when the name changes
  std::string description;    // "FT232R USB UART"
  std::string manufacturer;   // "FTDI"
  std::string serial_number;  // of the adapter
  int vendor_id = 0;          // of USB; 0: none
  int product_id = 0;
};

std::vector<PortInfo> listPorts();

// Which device file is meant by a path ("/dev/...", a link, a pseudo terminal), a bare name ("ttyUSB0"), or a
// part of what an adapter says about itself (by-id name, vendor, description, serial number; capitals do not
// matter). Fails, naming what is plugged in, where nothing or more than one thing fits.
Result<std::string> resolvePort(const std::string& wanted, const std::vector<PortInfo>& ports);

// Opens and owns it. A thread of its own takes bytes from the system as they come, so that none is lost while
// the owner is busy. Reading waits on the given clock, which must outlive the channel. A USB adapter's
// latency timer is set to 1 ms where the system lets us.
class SerialPort : public ByteChannel {
 public:
  static Result<std::unique_ptr<SerialPort>> open(const std::string& path, const LineSettings& line,
                                                  RealClock& clock);
  ~SerialPort() override;
  SerialPort(const SerialPort&) = delete;
  SerialPort& operator=(const SerialPort&) = delete;

  Result<std::size_t> read(std::span<Byte> buffer, Instant deadline) override;
  Status write(std::span<const Byte> bytes) override;
  Status setLine(const LineSettings& line) override;
  LineSettings line() const override;
  Status discardInput() override;
  ChannelState state() const override;
  void close() override;
  const std::string& name() const override;

 private:
  class Worker;
  explicit SerialPort(std::unique_ptr<Worker> worker);
  std::unique_ptr<Worker> worker_;
};

}  // namespace tiltmap
