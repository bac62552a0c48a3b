// Waiting for what comes about by itself.
#pragma once

#include <QCoreApplication>
#include <QElapsedTimer>

namespace tiltmap::test {

// What takes longer has come to nothing; no measure. Sanitizers slow a relaxation down by ten times and more.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
inline constexpr qint64 kPatienceMs = 300'000;
#else
inline constexpr qint64 kPatienceMs = 20'000;
#endif

// Runs the event loop until the condition holds; false when it does not within kPatienceMs.
template <class Condition>
bool waitUntil(const Condition& condition) {
  QElapsedTimer clock;
  clock.start();
  while (!condition()) {
    if (clock.elapsed() > kPatienceMs) return false;
    QCoreApplication::processEvents(QEventLoop::AllEvents, 10);
  }
  return true;
}

}  // namespace tiltmap::test
