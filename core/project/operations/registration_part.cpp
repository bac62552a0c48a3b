#include "core/project/operations/registration_part.h"

#include <array>
#include <bit>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <optional>

#include <nlohmann/json.hpp>

#include "core/base/atomic_file.h"
#include "core/base/text.h"
#include "core/project/judgement_json.h"

namespace tiltmap {

namespace {

using nlohmann::json;

constexpr std::string_view kFirstLine = "tiltmap registration part 2";
constexpr std::string_view kFirstWords = "tiltmap registration part ";
constexpr const char* kMakeAgain = "make this part again with `tiltmap register --shard`";

// FNV-1a, 64 bits.
class Print {
 public:
  void add(std::string_view bytes) {
    for (const char byte : bytes) value_ = (value_ ^ static_cast<unsigned char>(byte)) * 1099511628211ULL;
  }
  void add(std::int64_t number) {
    for (int k = 0; k < 8; ++k)
      value_ = (value_ ^ (static_cast<std::uint64_t>(number) >> (8 * k) & 0xffU)) * 1099511628211ULL;
  }
  void add(double number) { add(std::bit_cast<std::int64_t>(number)); }
  std::string text() const {
    constexpr std::string_view kDigits = "0123456789abcdef";
    std::string hex;
    for (int k = 60; k >= 0; k -= 4) hex += kDigits[value_ >> static_cast<unsigned>(k) & 15U];
    return hex;
  }

 private:
  std::uint64_t value_ = 14695981039346656037ULL;
};

std::string printOf(std::string_view bytes) {
  Print print;
  print.add(bytes);
  return print.text();
}

template <class Matrix>
json matrixJson(const Matrix& matrix) {
  json numbers = json::array();
  for (Eigen::Index i = 0; i < matrix.size(); ++i) numbers.push_back(exactNumber(matrix.data()[i]));
  return numbers;
}
template <class Matrix>
Matrix matrixOf(const json& numbers) {
  Matrix matrix;
  if (numbers.size() != static_cast<std::size_t>(matrix.size())) throw std::invalid_argument("wrong size");
  for (Eigen::Index i = 0; i < matrix.size(); ++i)
    matrix.data()[i] = exactNumberOf(numbers[static_cast<std::size_t>(i)]);
  return matrix;
}

json poseJson(const Pose& pose) {
  return {{"t", matrixJson(Eigen::Vector3d(pose.translation()))},
          {"q", matrixJson(Eigen::Vector4d(pose.quaternion().coeffs()))}};
}
Pose poseOf(const json& pose) {
  Eigen::Quaterniond q;
  q.coeffs() = matrixOf<Eigen::Vector4d>(pose.at("q"));
  return Pose::restored(q, matrixOf<Eigen::Vector3d>(pose.at("t")));
}

// One list of a structure's numbers, so that writing and reading cannot drift apart.
template <class Result, class Visit>
void resultNumbers(Result& r, Visit&& visit) {
  visit("rms", r.rms_m);
  visit("overlap", r.overlap);
  visit("agreement", r.agreement);
  visit("milliseconds", r.milliseconds);
}
json pairJson(const RegisteredPair& pair) {
  const PairResult& r = pair.result;
  json out = {{"fixed", pair.fixed},
              {"moving", pair.moving},
              {"pose", poseJson(r.fixed_from_moving)},
              {"start", poseJson(r.start)},
              {"retries", r.retries},
              {"iterations", r.iterations},
              {"correspondences", r.correspondences},
              {"ended", stopReasonName(r.stop_reason)},
              {"information", matrixJson(r.information)},
              {"pair_milliseconds", exactNumber(pair.milliseconds)},
              {"judgement", wholeJudgement(pair.judgement)},
              {"judging_milliseconds", exactNumber(pair.judgement.milliseconds)}};
  resultNumbers(r, [&out](const char* key, double value) { out[key] = exactNumber(value); });
  return out;
}

StopReason stopReasonOf(const std::string& name) {
  for (int k = 0; k <= static_cast<int>(StopReason::Cancelled); ++k)
    if (stopReasonName(static_cast<StopReason>(k)) == name) return static_cast<StopReason>(k);
  throw std::invalid_argument("no stop reason");
}

RegisteredPair pairOf(const json& in) {
  RegisteredPair pair;
  PairResult& r = pair.result;
  pair.fixed = in.at("fixed").get<int>();
  pair.moving = in.at("moving").get<int>();
  r.fixed_from_moving = poseOf(in.at("pose"));
  r.start = poseOf(in.at("start"));
  r.retries = in.at("retries").get<int>();
  r.iterations = in.at("iterations").get<int>();
  r.correspondences = in.at("correspondences").get<std::size_t>();
  r.stop_reason = stopReasonOf(in.at("ended").get<std::string>());
  r.information = matrixOf<Matrix6d>(in.at("information"));
  pair.milliseconds = exactNumberOf(in.at("pair_milliseconds"));
  pair.judgement = judgementOf(in.at("judgement"), r.fixed_from_moving);
  pair.judgement.milliseconds = exactNumberOf(in.at("judging_milliseconds"));
  resultNumbers(r, [&in](const char* key, double& value) { value = exactNumberOf(in.at(key)); });
  return pair;
}

RegistrationPart partOf(const json& in) {
  RegistrationPart part;
  part.program_version = in.at("program").get<std::string>();
  part.project_id = in.at("project").get<std::string>();
  part.shard = {in.at("shard").at(0).get<int>(), in.at("shard").at(1).get<int>()};
  part.preset = in.at("preset").get<std::string>();
  auto values = parametersFromJson(in.at("values").dump());
  if (!values) throw std::invalid_argument(values.error().what);
  part.values = std::move(*values);
  part.scans = in.at("scans").get<std::vector<std::string>>();
  part.started = in.at("started").get<std::string>();
  part.finished = in.at("finished").get<std::string>();
  part.milliseconds = exactNumberOf(in.at("milliseconds"));
  for (const json& pair : in.at("pairs")) part.pairs.push_back(pairOf(pair));
  return part;
}

std::optional<std::string> firstLineOf(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::array<char, 64> bytes{};
  file.read(bytes.data(), bytes.size());
  const std::string start(bytes.data(), static_cast<std::size_t>(file.gcount()));
  if (!start.starts_with(kFirstWords)) return {};
  return start.substr(0, start.find('\n'));
}

}  // namespace

Result<Shard> parseShard(const std::string& text) {
  constexpr long long kMost = 100'000;
  const auto ends = splitAt(trimmed(text), '/');
  const auto k = parseInteger(ends.front()), n = parseInteger(ends.back());
  if (ends.size() != 2 || !k || !n)
    return fail(printable(text) + " is not a part of a whole", "--shard", "write K/N, such as 2/8");
  if (*n < 1 || *n > kMost || *k < 1 || *k > *n)
    return fail("there is no part " + std::to_string(*k) + " of " + std::to_string(*n), "--shard",
                "count the parts from 1: 1/8 is the first of eight, 8/8 the last");
  return Shard{static_cast<int>(*k), static_cast<int>(*n)};
}

std::string shardName(const Shard& shard) {
  return std::to_string(shard.k) + "/" + std::to_string(shard.n);
}

std::vector<IndexPair> pairsOfShard(const std::vector<IndexPair>& pairs, const Shard& shard) {
  const auto border = [&](int k) {
    return static_cast<std::ptrdiff_t>(pairs.size() * static_cast<std::size_t>(k) /
                                       static_cast<std::size_t>(shard.n));
  };
  return {pairs.begin() + border(shard.k - 1), pairs.begin() + border(shard.k)};
}

std::vector<std::string> scanPrints(const ProjectSnapshot& snapshot) {
  std::vector<std::string> prints;
  for (const ScanEntry& scan : snapshot.scans()) {
    Print print;
    for (const std::int64_t number : {scan.id, scan.matrix, scan.geometry_id}) print.add(number);
    print.add(static_cast<std::int64_t>(scan.lines));
    const Pose& odometry = scan.odometry();
    for (int i = 0; i < 3; ++i) print.add(odometry.translation()[i]);
    for (int i = 0; i < 4; ++i) print.add(odometry.quaternion().coeffs()[i]);
    prints.push_back(print.text());
  }
  return prints;
}

Status writeRegistrationPart(const RegistrationPart& part, const std::filesystem::path& path) {
  std::error_code ignored;
  if (std::filesystem::exists(path, ignored) && !isRegistrationPart(path))
    return fail("there is something else already", path.string(),
                "choose another name; only an older part is replaced");
  json body = {{"program", part.program_version},
               {"project", part.project_id},
               {"shard", {part.shard.k, part.shard.n}},
               {"preset", part.preset},
               {"values", json::parse(parametersToJson(part.values))},
               {"scans", part.scans},
               {"started", part.started},
               {"finished", part.finished},
               {"milliseconds", exactNumber(part.milliseconds)},
               {"pairs", json::array()}};
  for (const RegisteredPair& pair : part.pairs) body["pairs"].push_back(pairJson(pair));
  const std::string text = body.dump(-1, ' ', false, json::error_handler_t::replace);
  return writeFileAtomically(path, std::string(kFirstLine) + "\n" + printOf(text) + "\n" + text + "\n");
}

Result<RegistrationPart> readRegistrationPart(const std::filesystem::path& path) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(path, ignored))
    return fail("there is no such file", path.string(), "name the parts that `tiltmap register` wrote");
  const auto first = firstLineOf(path);
  if (!first)
    return fail("this is no part of a registration", path.string(),
                "name files that `tiltmap register --shard K/N --out FILE` wrote");
  if (*first != kFirstLine)
    return fail("this part was written by another version of Tiltmap", path.string(),
                "use the same version on all machines");
  const auto damaged = [&] { return fail("this part is damaged or cut off", path.string(), kMakeAgain); };
  std::ifstream file(path, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(file), {}};
  const std::size_t sum_at = kFirstLine.size() + 1, text_at = sum_at + printOf("").size() + 1;
  if (file.bad() || bytes.size() < text_at + 1 || bytes.back() != '\n') return damaged();
  const std::string text = bytes.substr(text_at, bytes.size() - 1 - text_at);
  if (bytes.substr(sum_at, text_at - 1 - sum_at) != printOf(text)) return damaged();
  try {
    return partOf(json::parse(text));
  } catch (const json::exception&) {
    return damaged();
  } catch (const std::invalid_argument&) {
    return damaged();
  }
}

bool isRegistrationPart(const std::filesystem::path& path) {
  return firstLineOf(path).has_value();
}

}  // namespace tiltmap
