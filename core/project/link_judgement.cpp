#include "core/project/link_judgement.h"

#include <algorithm>
#include <atomic>
#include <map>
#include <numeric>

#include "core/base/parallel.h"
#include "core/project/operations/pair_links.h"

namespace tiltmap {

namespace {

constexpr std::size_t kAtATime = 96;  // pairs: bounds the scans in memory, each of some MB

Error cancelled() {
  return Error{kCancelled, "judge", "nothing was changed; start again when you like"};
}

}  // namespace

Result<std::vector<PairJudgement>> judgePairs(const std::vector<PairToJudge>& pairs,
                                              const std::function<Result<JudgedScanPtr>(std::size_t)>& scan,
                                              int threads, const JudgementSettings& settings,
                                              const JobControl& control) {
  // By their scans, so that a scan is soon done with.
  std::vector<std::size_t> order(pairs.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, [&](std::size_t k) {
    return std::pair(std::max(pairs[k].fixed, pairs[k].moving), std::min(pairs[k].fixed, pairs[k].moving));
  });
  std::vector<PairJudgement> judged(pairs.size());
  std::map<std::size_t, Result<JudgedScanPtr>> scans;
  std::atomic<std::size_t> done = 0;
  for (std::size_t from = 0; from < order.size(); from += kAtATime) {
    const std::size_t to = std::min(from + kAtATime, order.size());
    std::map<std::size_t, Result<JudgedScanPtr>> needed;
    for (std::size_t i = from; i < to; ++i)
      for (const std::size_t index : {pairs[order[i]].fixed, pairs[order[i]].moving}) {
        const auto known = scans.find(index);
        needed.emplace(index, known == scans.end() ? Result<JudgedScanPtr>(JudgedScanPtr()) : known->second);
      }
    scans = std::move(needed);
    std::vector<std::map<std::size_t, Result<JudgedScanPtr>>::value_type*> missing;
    for (auto& entry : scans)
      if (!*entry.second) missing.push_back(&entry);
    parallelFor(missing.size(), threads, [&](std::size_t i) {
      if (!control.stopRequested()) missing[i]->second = scan(missing[i]->first);
    });
    if (control.stopRequested()) return fail(cancelled());
    for (const auto& [index, made] : scans)
      if (!made) return fail(made.error());
    parallelFor(to - from, threads, [&](std::size_t i) {
      if (control.stopRequested()) return;
      const std::size_t k = order[from + i];
      judged[k] =
          judgePair(**scans.at(pairs[k].fixed), **scans.at(pairs[k].moving), pairs[k].claim, settings);
      control.tell(static_cast<double>(++done) / static_cast<double>(pairs.size()),
                   "judging " + std::to_string(pairs[k].moving) + " on " + std::to_string(pairs[k].fixed));
    });
    if (control.stopRequested()) return fail(cancelled());
  }
  return judged;
}

Result<std::vector<JudgedLink>> judgeLinkScans(const ProjectSnapshot& snapshot, int threads,
                                               const JudgementSettings& settings, const JobControl& control,
                                               const std::vector<LinkId>& links) {
  std::vector<PairToJudge> pairs;
  std::vector<JudgedLink> judged;
  for (const LinkId id : links)
    if (!snapshot.findLink(id))
      return fail("there is no link " + std::to_string(id), snapshot.path().string(),
                  "choose one that `tiltmap link list` shows");
  for (const Link& link : snapshot.links()) {
    if (!links.empty() && std::ranges::find(links, link.id) == links.end()) continue;
    PairToJudge pair;
    pair.fixed = snapshot.indexOf(link.fixed).value();
    pair.moving = snapshot.indexOf(link.moving).value();
    pair.claim.fixed_from_moving = link.fixed_from_moving;
    pair.claim.start = link.judgement
                           ? link.judgement->start
                           : odometryStart(snapshot.scans()[pair.fixed], snapshot.scans()[pair.moving]);
    pair.claim.succeeded = link.succeeded;
    if (!link.succeeded) pair.claim.ended = "registration ended with: " + link.stop_reason;
    pairs.push_back(std::move(pair));
    judged.push_back({link.id, {}});
  }
  const RegistrationSettings preparing;
  auto judgements = judgePairs(
      pairs,
      [&](std::size_t i) {
        return snapshot.scans()[i].scan().map(
            [&](const Scan& scan) { return judgedScan(prepare(scan, preparing)); });
      },
      threads, settings, control);
  if (!judgements) return fail(judgements.error());
  for (std::size_t k = 0; k < judged.size(); ++k) judged[k].judgement = std::move((*judgements)[k]);
  return judged;
}

ProjectEdit storeJudgementsEdit(const SnapshotPtr& base, const std::vector<JudgedLink>& judged) {
  ProjectEdit edit;
  edit.title = "judge " + std::to_string(judged.size()) + (judged.size() == 1 ? " link" : " links");
  edit.base = base;
  SetLinkJudgements step;
  for (const JudgedLink& one : judged) {
    step.judgements.emplace_back(one.link, std::make_shared<const PairJudgement>(one.judgement));
    if (const Link* link = base->findLink(one.link)) {
      edit.concerned.push_back(link->fixed);
      edit.concerned.push_back(link->moving);
    }
  }
  if (!step.judgements.empty()) edit.steps.emplace_back(std::move(step));
  return edit;
}

}  // namespace tiltmap
