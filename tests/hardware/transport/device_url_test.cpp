#include "hardware/transport/device_url.h"

#include <gtest/gtest.h>

#include "hardware/transport/serial_port.h"

namespace tiltmap {
namespace {

TEST(DeviceUrl, SchemeEndsAtTheFirstColonAndOptionsBeginAtTheLastQuestionMark) {
  const auto url = parseDeviceUrl(
      "lms2xx:/dev/serial/by-path/pci-0000:00:14.0-usb?0?baud=38400&resolution=0.5", scannerSchemes());
  ASSERT_TRUE(url) << url.error().what;
  EXPECT_EQ(url->scheme, "lms2xx");
  EXPECT_EQ(url->port, "/dev/serial/by-path/pci-0000:00:14.0-usb?0");
  EXPECT_EQ(url->integer("baud", 300, 1000000).value(), 38400);
  EXPECT_EQ(url->number("resolution", 0, 1).value(), 0.5);
  EXPECT_EQ(url->number("angle", 0, 180).value(), std::nullopt);
  EXPECT_EQ(parseDeviceUrl(url->text(), scannerSchemes())->text(), url->text());
  const auto manual = parseDeviceUrl("manual:", tiltSchemes());
  ASSERT_TRUE(manual);
  EXPECT_EQ(manual->port, "");
  EXPECT_EQ(manual->text(), "manual:");
}

TEST(DeviceUrl, SaysWhatWouldHaveBeenRight) {
  const auto error = [](std::string_view text, const std::vector<DeviceScheme>& known) {
    const auto url = parseDeviceUrl(text, known);
    return url ? Error{} : url.error();
  };
  EXPECT_NE(error("/dev/ttyUSB0", scannerSchemes()).what.find("no colon"), std::string::npos);
  EXPECT_NE(error("/dev/ttyUSB0", scannerSchemes()).remedy.find("lms2xx:/dev/ttyUSB0"), std::string::npos);
  EXPECT_NE(error("lms2x:/dev/ttyUSB0", scannerSchemes()).remedy.find("did you mean lms2xx:?"),
            std::string::npos);
  EXPECT_NE(error("mip50:/dev/ttyUSB0", scannerSchemes()).what.find("mip50"), std::string::npos);
  EXPECT_NE(error("lms2xx:", scannerSchemes()).what.find("port is missing"), std::string::npos);
  EXPECT_NE(error("lms2xx:?baud=9600", scannerSchemes()).what.find("port is missing"), std::string::npos);
  EXPECT_NE(error("manual:/dev/ttyUSB0", tiltSchemes()).what.find("takes no port"), std::string::npos);
  EXPECT_NE(error("lms2xx:a?bauds=9600", scannerSchemes()).remedy.find("did you mean baud?"),
            std::string::npos);
  EXPECT_NE(error("lms2xx:a?baud", scannerSchemes()).what.find("no value"), std::string::npos);
  EXPECT_NE(error("lms2xx:a?baud=", scannerSchemes()).what.find("no value"), std::string::npos);
  EXPECT_NE(error("lms2xx:a?baud=1&baud=2", scannerSchemes()).what.find("twice"), std::string::npos);
  EXPECT_NE(error("manual:?baud=1", tiltSchemes()).what.find("no option"), std::string::npos);
  const auto url = parseDeviceUrl("lms2xx:a?baud=fast", scannerSchemes());
  ASSERT_TRUE(url);
  EXPECT_FALSE(url->integer("baud", 300, 1000000));
  EXPECT_FALSE(parseDeviceUrl("lms2xx:a?baud=299", scannerSchemes())->integer("baud", 300, 1000000));
  EXPECT_FALSE(parseDeviceUrl("lms2xx:a?baud=300.5", scannerSchemes())->integer("baud", 300, 1000000));
}

std::vector<PortInfo> twoAdapters() {
  return {{"/dev/ttyUSB0", "/dev/serial/by-id/usb-FTDI_FT232R_A50285BI-if00-port0", "FT232R USB UART", "FTDI",
           "A50285BI", 0x0403, 0x6001},
          {"/dev/ttyUSB1", "/dev/serial/by-id/usb-Silicon_Labs_CP2102_0001-if00-port0",
           "CP2102 USB to UART Bridge", "Silicon Labs", "0001", 0x10c4, 0xea60}};
}

TEST(ResolvePort, ByNamePathOrWhatTheAdapterSaysOfItself) {
  const auto ports = twoAdapters();
  EXPECT_EQ(resolvePort("ttyUSB1", ports).value(), "/dev/ttyUSB1");
  EXPECT_EQ(resolvePort("/dev/pts/7", ports).value(), "/dev/pts/7");
  EXPECT_EQ(resolvePort("./scanner-link", ports).value(), "./scanner-link");
  // The name that stays, not the one of today.
  EXPECT_EQ(resolvePort("ftdi", ports).value(), ports[0].by_id);
  EXPECT_EQ(resolvePort("silicon labs", ports).value(), ports[1].by_id);
  EXPECT_EQ(resolvePort("A50285", ports).value(), ports[0].by_id);
}

TEST(ResolvePort, NamesWhatIsThereWhereNothingOrTooMuchFits) {
  const auto ports = twoAdapters();
  const auto both = resolvePort("uart", ports);
  ASSERT_FALSE(both);
  EXPECT_NE(both.error().what.find("/dev/ttyUSB0"), std::string::npos);
  EXPECT_NE(both.error().what.find("/dev/ttyUSB1"), std::string::npos);
  const auto none = resolvePort("Prolific", ports);
  ASSERT_FALSE(none);
  EXPECT_NE(none.error().remedy.find("CP2102"), std::string::npos);
  EXPECT_NE(resolvePort("Prolific", {}).error().remedy.find("nothing is plugged in"), std::string::npos);
  EXPECT_FALSE(resolvePort("", ports));
}

TEST(ListPorts, DoesNotFail) {
  for (const PortInfo& port : listPorts()) EXPECT_TRUE(port.path.starts_with("/dev/")) << port.path;
}

}  // namespace
}  // namespace tiltmap
