// A server of odometry lines at this machine, on a thread of its own.
#pragma once

#include <array>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <stdexcept>
#include <string>
#include <thread>

#include "hardware/transport/tcp_channel.h"

namespace tiltmap::test {

class FeedServer {
 public:
  // Port 0: any that is free.
  explicit FeedServer(int port = 0) {
    auto wire = TcpWire::listen(clock_, port);
    if (!wire) throw std::runtime_error(wire.error().what);
    wire_ = std::move(*wire);
    port_ = wire_->port();
    thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
  }
  TcpAddress address() const { return {"127.0.0.1", port_}; }

  // Sent once somebody is connected. Lines end where the text has their ends.
  void send(std::string text) {
    order([this, text = std::move(text)] { (void)wire_->write(ByteVector(text.begin(), text.end())); });
  }
  // What is ordered afterwards waits for the next client.
  void hangUp() {
    order([this] {
      wire_->hangUp();
      needed_ = wire_->clients() + 1;
    });
  }
  // A line of the feed.
  static std::string line(double stamp_s, double x_m = 0.0, double y_m = 0.0) {
    return std::to_string(stamp_s) + " " + std::to_string(x_m) + " " + std::to_string(y_m) + " 0 0 0 0 1\n";
  }

 private:
  void order(std::function<void()> what) {
    const std::lock_guard lock(mutex_);
    orders_.push_back(std::move(what));
  }
  void run(const std::stop_token& stop) {
    while (!stop.stop_requested()) {
      std::array<Byte, 64> ignored;
      (void)wire_->read(ignored, clock_.now() + durationOf(0.005));
      if (wire_->clients() < needed_) continue;
      std::function<void()> next;
      {
        const std::lock_guard lock(mutex_);
        if (orders_.empty()) continue;
        next = std::move(orders_.front());
        orders_.pop_front();
      }
      next();
    }
  }

  RealClock clock_;
  std::unique_ptr<TcpWire> wire_;
  int port_ = 0, needed_ = 1;  // clients so far, before an order is carried out
  std::mutex mutex_;
  std::deque<std::function<void()>> orders_;
  std::jthread thread_;
};

}  // namespace tiltmap::test
