#include "core/multiview/relaxation_text.h"

#include "core/base/text.h"

namespace tiltmap {

namespace {

std::string millimetres(double metres) {
  return fixedReal(1000.0 * metres, 1) + " mm";
}

std::string motion(const RelaxationEvent& event) {
  return millimetres(event.translation_m) + ", " + fixedReal(event.rotation_rad / kDegree, 3) + "°";
}

std::string scanName(int scan) {
  return "scan " + std::to_string(scan);
}

std::string withText(std::string sentence, const RelaxationEvent& event) {
  return event.text.empty() ? sentence : sentence + ": " + event.text;
}

}  // namespace

std::string relaxationEventText(const RelaxationEvent& event) {
  const std::string pairs = std::to_string(event.pairs);
  switch (event.kind) {
    case RelaxationEventKind::Activated:
      return scanName(event.scan) + " comes into the active set, with " + pairs +
             (event.pairs == 1 ? " neighbour there" : " neighbours there");
    case RelaxationEventKind::Queued:
      return scanName(event.scan) + " is queued" +
             (event.other >= 0 ? ", because " + scanName(event.other) + " moved" : std::string());
    case RelaxationEventKind::Aligned:
      return withText(scanName(event.scan) + " aligned" +
                          (event.other >= 0 ? " with " + scanName(event.other) : " with its neighbours") +
                          ", " + pairs + " pairs, rms " + millimetres(event.rms_m),
                      event);
    case RelaxationEventKind::MovedBy:
      return scanName(event.scan) + " moved by " + motion(event);
    case RelaxationEventKind::Kept:
      return withText(scanName(event.scan) + " stays", event);
    case RelaxationEventKind::VisitBound:
      return scanName(event.scan) + " is not queued again: it has been visited as often as allowed";
    case RelaxationEventKind::LinksFound:
      return pairs + " overlapping pairs of scans";
    case RelaxationEventKind::Solved:
      return "solved over " + pairs + " pairs of surfaces, rms " + millimetres(event.rms_m) +
             "; the largest motion " + motion(event);
    case RelaxationEventKind::Unlinked:
      return scanName(event.scan) + " has no link to the others and keeps its start";
    case RelaxationEventKind::LinkDropped:
      return withText(
          "scans " + std::to_string(event.scan) + " and " + std::to_string(event.other) + " do not fit",
          event);
    case RelaxationEventKind::Finished:
      return "finished";
    case RelaxationEventKind::Cancelled:
      return "cancelled";
  }
  return {};
}

}  // namespace tiltmap
