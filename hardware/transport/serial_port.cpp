#include "hardware/transport/serial_port.h"

#include <QSerialPort>
#include <QThread>
#include <condition_variable>
#include <deque>
#include <filesystem>
#include <fstream>
#include <functional>
#include <future>
#include <mutex>
#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

namespace tiltmap {

namespace {

constexpr int kWriteLimitMs = 5000;

QSerialPort::Parity qtParity(Parity parity) {
  switch (parity) {
    case Parity::Even:
      return QSerialPort::EvenParity;
    case Parity::Odd:
      return QSerialPort::OddParity;
    case Parity::None:
      break;
  }
  return QSerialPort::NoParity;
}

std::string textOf(const QSerialPort& port) {
  return port.errorString().toStdString();
}

Error openError(const QSerialPort& port, const std::string& path) {
  switch (port.error()) {
    case QSerialPort::DeviceNotFoundError:
      return {"there is no such port", path, "`tiltmap devices` lists what is plugged in"};
    case QSerialPort::PermissionError:
      return {"the port is in use by another program, or you may not use it", path,
              "close the other program; add yourself to the group dialout and log in again"};
    default:
      return {"cannot open the port: " + textOf(port), path, "unplug the adapter and plug it in again"};
  }
}

// The driver of FTDI adapters holds short answers back for 16 ms unless told otherwise.
void shortenLatency(const std::string& path) {
  std::error_code ignored;
  const auto device = std::filesystem::canonical(path, ignored);
  if (ignored) return;
  const auto knob = std::filesystem::path("/sys/class/tty") / device.filename() / "device/latency_timer";
  if (std::filesystem::exists(knob, ignored)) std::ofstream(knob) << 1;
}

}  // namespace

// Everything of Qt lives on this thread, which Qt started, so that no other needs an event loop. It sleeps on
// the port and on a wake-up of our own, not in Qt, so that a command is done at once.
class SerialPort::Worker : public QThread {
 public:
  Worker(std::string path, LineSettings line, RealClock& clock)
      : clock_(clock), path_(std::move(path)), line_(line), wake_(eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC)) {}
  ~Worker() override {
    finish(ChannelState::Closed);
    wait();
    ::close(wake_);
  }

  Status begin() {
    auto opened = opened_.get_future();
    start();
    return opened.get();
  }

  Status command(std::function<Status(QSerialPort&)> task) {
    auto promise = std::make_shared<std::promise<Status>>();
    auto done = promise->get_future();
    {
      const std::lock_guard lock(mutex_);
      if (state_ != ChannelState::Open) return fail(gone());
      tasks_.push_back(
          [promise, task = std::move(task)](QSerialPort& port) { promise->set_value(task(port)); });
    }
    wakeUp();
    return done.get();
  }

  Result<std::size_t> read(std::span<Byte> buffer, Instant deadline) {
    std::unique_lock lock(mutex_);
    const auto ready = [this] { return !input_.empty() || state_ != ChannelState::Open; };
    if (!ready() && deadline > clock_.now()) {
      if (deadline == kNever)
        arrived_.wait(lock, ready);
      else
        arrived_.wait_until(lock, clock_.systemTime(deadline), ready);
    }
    std::size_t count = 0;
    for (; count < buffer.size() && !input_.empty(); ++count) {
      buffer[count] = input_.front();
      input_.pop_front();
    }
    if (count == 0 && state_ != ChannelState::Open) return fail(gone());
    return count;
  }

  void finish(ChannelState state) {
    {
      const std::lock_guard lock(mutex_);
      if (state_ == ChannelState::Open) state_ = state;
    }
    arrived_.notify_all();
    wakeUp();
  }

  Error gone() const {
    if (state_ == ChannelState::Closed) return {"the port was closed", path_, "open it again"};
    return {"the port is gone: the cable or adapter was unplugged", path_,
            "plug it in again; it is found again by its by-id name even where its number has changed"};
  }

  RealClock& clock_;
  const std::string path_;
  mutable std::mutex mutex_;
  std::condition_variable arrived_;
  std::deque<Byte> input_;
  ChannelState state_ = ChannelState::Open;
  LineSettings line_;

 protected:
  void run() override {
    QSerialPort port(QString::fromStdString(path_));
    port.setBaudRate(line_.baud);
    port.setDataBits(QSerialPort::Data8);
    port.setStopBits(QSerialPort::OneStop);
    port.setParity(qtParity(line_.parity));
    port.setFlowControl(QSerialPort::NoFlowControl);
    if (!port.open(QIODevice::ReadWrite)) {
      {
        const std::lock_guard lock(mutex_);
        state_ = ChannelState::Lost;
      }
      opened_.set_value(fail(openError(port, path_)));
      return;
    }
    shortenLatency(path_);
    opened_.set_value({});
    while (turn(port)) {
    }
    runTasks(port);  // nobody waits for ever
    port.close();
  }

 private:
  void wakeUp() {
    const std::uint64_t one = 1;
    // It can only fail where the counter is full, and then the thread wakes up anyway.
    [[maybe_unused]] const auto written = ::write(wake_, &one, sizeof one);
  }

  bool turn(QSerialPort& port) {
    pollfd watched[2] = {{port.handle(), POLLIN, 0}, {wake_, POLLIN, 0}};
    poll(watched, 2, 1000);
    if (watched[1].revents) {
      std::uint64_t count = 0;
      [[maybe_unused]] const auto taken = ::read(wake_, &count, sizeof count);
    }
    runTasks(port);
    if (watched[0].revents) {
      port.waitForReadyRead(0);
      take(port.readAll());
      const auto error = port.error();
      // Depending on the adapter a vanished port shows as one or the other.
      if (error == QSerialPort::ResourceError || error == QSerialPort::ReadError ||
          (watched[0].revents & (POLLHUP | POLLERR | POLLNVAL)))
        finish(ChannelState::Lost);
      port.clearError();
    }
    const std::lock_guard lock(mutex_);
    return state_ == ChannelState::Open;
  }

  void take(const QByteArray& bytes) {
    if (bytes.isEmpty()) return;
    {
      const std::lock_guard lock(mutex_);
      for (const char byte : bytes) input_.push_back(static_cast<Byte>(byte));
    }
    arrived_.notify_all();
  }

  void runTasks(QSerialPort& port) {
    for (;;) {
      std::function<void(QSerialPort&)> task;
      {
        const std::lock_guard lock(mutex_);
        if (tasks_.empty()) return;
        task = std::move(tasks_.front());
        tasks_.pop_front();
      }
      task(port);
      // Waiting for bytes to leave also takes in what arrives meanwhile.
      take(port.readAll());
    }
  }

  const int wake_;
  std::promise<Status> opened_;
  std::deque<std::function<void(QSerialPort&)>> tasks_;
};

Result<std::unique_ptr<SerialPort>> SerialPort::open(const std::string& path, const LineSettings& line,
                                                     RealClock& clock) {
  auto worker = std::make_unique<Worker>(path, line, clock);
  if (const auto begun = worker->begin(); !begun) return fail(begun.error());
  return std::unique_ptr<SerialPort>(new SerialPort(std::move(worker)));
}

SerialPort::SerialPort(std::unique_ptr<Worker> worker) : worker_(std::move(worker)) {}
SerialPort::~SerialPort() = default;

Result<std::size_t> SerialPort::read(std::span<Byte> buffer, Instant deadline) {
  return worker_->read(buffer, deadline);
}

Status SerialPort::write(std::span<const Byte> bytes) {
  Worker* worker = worker_.get();
  return worker->command([worker, bytes](QSerialPort& port) -> Status {
    const auto size = static_cast<qint64>(bytes.size());
    bool sent = port.write(reinterpret_cast<const char*>(bytes.data()), size) == size;
    while (sent && port.bytesToWrite() > 0) sent = port.waitForBytesWritten(kWriteLimitMs);
    if (sent) return {};
    const bool late = port.error() == QSerialPort::TimeoutError;
    port.clearError();
    if (late)
      return fail("the port takes no bytes", worker->path_,
                  "look at the cable and the adapter; unplug the adapter and plug it in again");
    worker->finish(ChannelState::Lost);
    return fail(worker->gone());
  });
}

Status SerialPort::setLine(const LineSettings& line) {
  Worker* worker = worker_.get();
  return worker->command([worker, line](QSerialPort& port) -> Status {
    if (!port.setBaudRate(line.baud) || !port.setParity(qtParity(line.parity))) {
      port.clearError();
      return fail("the port cannot do " + std::to_string(line.baud) + " Bd", worker->path_,
                  "use a lower rate, or an adapter that can do it (500000 Bd needs RS-422)");
    }
    const std::lock_guard lock(worker->mutex_);
    worker->line_ = line;
    return {};
  });
}

LineSettings SerialPort::line() const {
  const std::lock_guard lock(worker_->mutex_);
  return worker_->line_;
}

Status SerialPort::discardInput() {
  const std::lock_guard lock(worker_->mutex_);
  worker_->input_.clear();
  if (worker_->state_ != ChannelState::Open) return fail(worker_->gone());
  return {};
}

ChannelState SerialPort::state() const {
  const std::lock_guard lock(worker_->mutex_);
  return worker_->state_;
}

void SerialPort::close() {
  worker_->finish(ChannelState::Closed);
  worker_->wait();
}

const std::string& SerialPort::name() const {
  return worker_->path_;
}

}  // namespace tiltmap
