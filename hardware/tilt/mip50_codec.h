// The MIP 50's ASCII mode as bytes: commands one way, answers the other. No clocks, no ports.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "hardware/tilt/mip50_table.h"

namespace tiltmap {

enum class Mip50Verb {
  ClearError,
  Ramp,
  Speed,
  RegulationOn,
  RegulationOff,
  Home,
  MoveAbsolute,
  MoveRelative,
  ReadPosition,
  ReadParameter,
  WriteParameter,
};

struct Mip50Command {
  Mip50Verb verb = Mip50Verb::ReadPosition;
  int axis = 1;
  double value = 0.0;  // counts, counts/ms, counts/ms2 or a parameter's value
  int parameter = 0;

  bool operator==(const Mip50Command&) const = default;
};

// The command's characters without the table's command_end; empty where the table has no such command.
std::string encodeCommand(const Mip50Table& table, const Mip50Command& command);
// The other way; nothing for what the table does not have.
std::optional<Mip50Command> decodeCommand(const Mip50Table& table, std::string_view text);

struct Mip50Done {
  bool operator==(const Mip50Done&) const = default;
};
struct Mip50Value {  // M#21 axis position; M#20 axis error; M#26 axis parameter value; others unknown
  int number = 0;
  std::vector<std::int64_t> values;  // from the axis on
  bool operator==(const Mip50Value&) const = default;
};
struct Mip50Refusal {
  int number = 0;
  int axis = 0;
  char letter = 0;  // of the command; 0 where it does not tell
  bool operator==(const Mip50Refusal&) const = default;
};
struct Mip50Banner {
  bool entered = true;  // else left
  bool operator==(const Mip50Banner&) const = default;
};
struct Mip50Noise {  // a line that means nothing
  std::string text;
  bool operator==(const Mip50Noise&) const = default;
};
using Mip50Answer = std::variant<Mip50Done, Mip50Value, Mip50Refusal, Mip50Banner, Mip50Noise>;

// As the controller sends it: every line after CR LF, values and refusals with another CR LF behind.
std::string encodeAnswer(const Mip50Table& table, const Mip50Answer& answer);

// Cuts what the controller sends into answers, however the bytes come in portions. Any run of CR and LF
// separates; "done" counts as soon as its characters stand at the start of a line, because it is not known
// whether a line end follows them. Holds at most kLongestLine bytes of an unfinished line.
class Mip50AnswerReader {
 public:
  static constexpr std::size_t kLongestLine = 160;

  explicit Mip50AnswerReader(const Mip50Table& table) : table_(&table) {}
  // Answers completed by these bytes are appended.
  void take(std::string_view bytes, std::vector<Mip50Answer>& answers);
  void clear();
  std::size_t pending() const { return line_.size(); }

 private:
  void finishLine(std::vector<Mip50Answer>& answers);
  const Mip50Table* table_;
  std::string line_;
  bool skipping_ = false;  // the rest of a line that was too long
};

// The controller's side: commands end with G (whatever blanks and line ends stand between them).
class Mip50CommandReader {
 public:
  static constexpr std::size_t kLongestCommand = 80;
  enum class Trouble { Unknown, TooLong };
  using Item = std::variant<Mip50Command, Trouble>;

  explicit Mip50CommandReader(const Mip50Table& table) : table_(&table) {}
  void take(std::string_view bytes, std::vector<Item>& items);
  void clear();
  bool between() const { return text_.empty(); }  // no command has begun

 private:
  const Mip50Table* table_;
  std::string text_;
  bool too_long_ = false;
};

}  // namespace tiltmap
