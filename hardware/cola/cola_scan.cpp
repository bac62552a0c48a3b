// The telegram LMDscandata of dialect A, both ways.
#include <algorithm>

#include "core/base/text.h"
#include "hardware/cola/cola_codec.h"

namespace tiltmap::cola {

namespace {

constexpr std::uint32_t kMostValues = 20000;
constexpr std::uint32_t kMostChannels = 32;

// Takes the words one after the other; the first that does not fit ends it.
class Words {
 public:
  explicit Words(std::vector<std::string_view> words) : words_(std::move(words)) {}
  bool good() const { return good_; }
  std::size_t at() const { return at_; }
  std::string_view word() {
    if (at_ >= words_.size()) {
      good_ = false;
      return {};
    }
    return words_[at_++];
  }
  std::uint32_t value() { return checked(number(word())); }
  std::uint32_t countUpTo(std::uint32_t most) {
    const std::uint32_t count = value();
    if (count <= most) return count;
    good_ = false;
    return 0;
  }
  std::int32_t signedValue() { return static_cast<std::int32_t>(value()); }
  float real() { return checked(realNumber(word())); }
  std::vector<std::string> rest() {
    std::vector<std::string> left;
    for (; at_ < words_.size(); ++at_) left.emplace_back(words_[at_]);
    return left;
  }

 private:
  template <class T>
  T checked(const std::optional<T>& given) {
    if (!given) good_ = false;
    return given.value_or(T{});
  }
  std::vector<std::string_view> words_;
  std::size_t at_ = 0;
  bool good_ = true;
};

std::vector<Channel> readChannels(Words& words, std::uint32_t most_value) {
  std::vector<Channel> channels(words.countUpTo(kMostChannels));
  for (Channel& channel : channels) {
    channel.name = std::string(words.word());
    channel.scale = words.real();
    channel.offset = words.real();
    channel.start = words.signedValue();
    channel.step = words.value();
    channel.values.resize(words.countUpTo(kMostValues));
    for (std::uint16_t& value : channel.values) {
      value = static_cast<std::uint16_t>(words.countUpTo(most_value));
      if (!words.good()) return {};
    }
    if (!words.good()) return {};
  }
  return channels;
}

class Writer {
 public:
  explicit Writer(std::string begin) : text_(std::move(begin)) {}
  Writer& word(std::string_view word) {
    text_ += ' ';
    text_ += word;
    return *this;
  }
  Writer& value(std::uint32_t value) { return word(hexNumber(value)); }
  Writer& values(std::initializer_list<std::uint32_t> all) {
    for (const std::uint32_t each : all) value(each);
    return *this;
  }
  void channels(const std::vector<Channel>& channels) {
    value(static_cast<std::uint32_t>(channels.size()));
    for (const Channel& channel : channels) {
      word(channel.name).word(hexReal(channel.scale)).word(hexReal(channel.offset));
      values({static_cast<std::uint32_t>(channel.start), channel.step,
              static_cast<std::uint32_t>(channel.values.size())});
      for (const std::uint16_t each : channel.values) value(each);
    }
  }
  std::string text() { return std::move(text_); }

 private:
  std::string text_;
};

}  // namespace

const Channel* Scan::channel(std::string_view name) const {
  for (const auto* list : {&channels16, &channels8})
    if (const auto found = std::ranges::find(*list, name, &Channel::name); found != list->end())
      return &*found;
  return nullptr;
}

bool isScan(std::string_view text) {
  return text.starts_with("sSN LMDscandata ") || text.starts_with("sRA LMDscandata ");
}

Result<Scan> parseScan(std::string_view text) {
  if (!isScan(text)) return fail("it is no scan", printable(text), "");
  Scan scan;
  scan.asked = text.starts_with("sRA");
  Words words(splitAt(text, ' '));
  words.word();
  words.word();
  for (std::uint32_t* field : {&scan.version, &scan.device, &scan.serial, &scan.status_high, &scan.status_low,
                               &scan.telegrams, &scan.scans, &scan.measured_us, &scan.sent_us,
                               &scan.inputs_high, &scan.inputs_low, &scan.outputs_high, &scan.outputs_low,
                               &scan.reserved, &scan.frequency_chz, &scan.measuring_frequency})
    *field = words.value();
  scan.encoders.resize(words.countUpTo(kMostChannels));
  for (Encoder& encoder : scan.encoders) {
    encoder.position = words.value();
    encoder.speed = words.signedValue();
  }
  if (words.good()) scan.channels16 = readChannels(words, 0xFFFF);
  if (words.good()) scan.channels8 = readChannels(words, 0xFF);
  if (!words.good())
    return fail("the scan is not understood", "word " + std::to_string(words.at()),
                "record the session (?log=FILE) and report it");
  scan.rest = words.rest();
  return scan;
}

std::string scanText(const Scan& scan) {
  Writer writer(scan.asked ? "sRA LMDscandata" : "sSN LMDscandata");
  writer.values({scan.version, scan.device, scan.serial, scan.status_high, scan.status_low, scan.telegrams,
                 scan.scans, scan.measured_us, scan.sent_us, scan.inputs_high, scan.inputs_low,
                 scan.outputs_high, scan.outputs_low, scan.reserved, scan.frequency_chz,
                 scan.measuring_frequency, static_cast<std::uint32_t>(scan.encoders.size())});
  for (const Encoder& encoder : scan.encoders)
    writer.value(encoder.position).value(static_cast<std::uint32_t>(encoder.speed));
  writer.channels(scan.channels16);
  writer.channels(scan.channels8);
  for (const std::string& word : scan.rest) writer.word(word);
  return writer.text();
}

}  // namespace tiltmap::cola
