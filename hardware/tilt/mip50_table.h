// The strings, numbers and time limits of the MIP 50's ASCII mode, as a table that a person can edit.
//
// Only a part of the command set is public, and no more than a part of it has been seen working (the manual's
// page on capturing says which). Whoever has the controller and its printed guide can mend a line of the
// table without a new program.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <string_view>

#include "core/base/result.h"

namespace tiltmap {

// Commands are patterns: {axis}, {value} and {parameter} stand for numbers. An empty command is one that the
// controller does not have.
struct Mip50Table {
  std::string clear_error = "E{axis}xG";
  std::string ramp = "C{axis}x2r2t{value}G";  // counts/ms2, up and down
  std::string speed = "V{axis}x{value}G";     // counts/ms
  std::string regulation_on = "n{axis}xG";
  std::string regulation_off = "f{axis}xG";
  std::string home = "H{axis}xG";
  std::string move_absolute = "A{axis}x{value}G";  // counts
  std::string move_relative = "R{axis}x{value}G";
  std::string read_position = "P{axis}xG";
  std::string read_parameter = "q{axis}x{parameter}pG";
  std::string write_parameter = "w{axis}x{parameter}p{value}G";
  std::string enter_ascii = "$P";  // from the text menu
  std::string leave_ascii = "Q";   // back to it
  // Stops a move that is under way: out of the ASCII mode, then the text menu's emergency stop. After what
  // the menu says of itself; not tried. Empty: it cannot be done, and long moves are not begun.
  std::string interrupt = "Q\r";
  std::string command_end = "\r\n";  // sent after each command; the controller goes by the G

  std::string done = "X0";  // the command is completed; for a move: the motion has ended
  std::string value_prefix = "M#";
  std::string refusal_prefix = "E#";
  std::string banner = "P0 ASCII - Commandmode";
  std::string banner_end = "P0 End ASCII - Commandmode";
  int position_number = 21;   // M#21 axis counts
  int error_number = 20;      // M#20 axis number
  int parameter_number = 26;  // M#26 axis parameter value

  double answer_s = 1.0;        // until a command that moves nothing is answered
  double move_factor = 2.0;     // a move may take so many times its computed duration ...
  double move_extra_s = 2.0;    // ... and so much more
  double home_limit_s = 120.0;  // until homing has ended: the gear is slow
  int repeats = 3;              // of a command that was not answered

  // What a refusal's number means; where the numbers are not sure, see the manual.
  std::map<int, std::string> refusals = {
      {171, "unknown command"},
      {172, "syntax error"},
      {173, "the line is too long"},
      {174, "the value is out of range"},
      {175, "there is no such parameter"},
      {176, "an error has not been cleared"},
      {177, "not allowed at present"},
      {178, "a motion has not started or not ended"},
      {179, "time-out"},
      {180, "position regulation is off"},
      {181, "current regulation is off"},
      {182, "the Enable input is not active"},
      {183, "STOP is active"},
      {184, "the left limit switch is active"},
      {185, "the right limit switch is active"},
      {186, "an error needs a reset"},
      {187, "a reset of the hardware is needed"},
      {188, "the flash memory has a problem"},
  };
  std::map<int, std::string> errors = {};  // what M#20 tells; the numbers are not public

  bool operator==(const Mip50Table&) const = default;
};

// `name = value` a line; "#" begins a remark; blanks around a value are not part of it, \r, \n, \t, \s
// (blank),
// \\ and \xNN stand for characters; refusal.N and error.N give a number its meaning. Names that are not there
// keep their built-in value. Refuses unknown names (naming the nearest), numbers that are none, and a command
// without what it needs ({axis}, {value}, {parameter}).
Result<Mip50Table> parseMip50Table(std::string_view text, const std::string& where);
Result<Mip50Table> readMip50Table(const std::filesystem::path& file);
// The whole table in that form, with a remark a line: what a person begins to edit from.
std::string mip50TableText(const Mip50Table& table);

}  // namespace tiltmap
