// A file system for SQLite that fails at the n-th write: killed, power cut, disk full.
#pragma once

#include <algorithm>
#include <atomic>
#include <csignal>
#include <cstring>
#include <list>
#include <new>
#include <string>
#include <unistd.h>
#include <vector>

#include <sqlite3.h>

namespace tiltmap::test {

enum class Fault {
  None,
  Kill,      // SIGKILL instead of the write
  TornKill,  // half of the write, then SIGKILL
  PowerCut,  // what has not been synced is lost, then SIGKILL
  Full,      // this write and all later ones fail with SQLITE_FULL
};

// Everything SQLite opens in this process goes through it while it lives. One at a time.
class FaultVfs {
 public:
  FaultVfs(Fault fault, int at_write) {
    plan() = Plan{fault, at_write, sqlite3_vfs_find(nullptr), {}};
    writes() = 0;
    vfs_ = *plan().real;
    vfs_.zName = "tiltmap-fault";
    vfs_.pNext = nullptr;
    vfs_.szOsFile = static_cast<int>(sizeof(File)) + plan().real->szOsFile;
    vfs_.xOpen = open;
    sqlite3_vfs_register(&vfs_, 1);
  }
  ~FaultVfs() { sqlite3_vfs_unregister(&vfs_); }
  FaultVfs(const FaultVfs&) = delete;
  FaultVfs& operator=(const FaultVfs&) = delete;

  static std::atomic<int>& writes() {
    static std::atomic<int> count{0};
    return count;
  }

 private:
  struct File {
    sqlite3_file base;
    sqlite3_file* real;
  };
  // What a write not yet synced has replaced.
  struct Unsynced {
    File* file;
    sqlite3_int64 offset;
    std::vector<char> old_bytes;
    sqlite3_int64 old_size;
  };
  struct Plan {
    Fault fault = Fault::None;
    int at_write = 0;
    sqlite3_vfs* real = nullptr;
    std::list<Unsynced> unsynced;
  };
  static Plan& plan() {
    static Plan the_plan;
    return the_plan;
  }
  static File* of(sqlite3_file* file) { return reinterpret_cast<File*>(file); }
  static sqlite3_file* realOf(sqlite3_file* file) { return of(file)->real; }

  static void remember(File* file, sqlite3_int64 offset, sqlite3_int64 amount) {
    if (plan().fault != Fault::PowerCut) return;
    Unsynced entry{file, offset, {}, 0};
    file->real->pMethods->xFileSize(file->real, &entry.old_size);
    const sqlite3_int64 kept = std::min(amount, entry.old_size - offset);
    if (kept > 0) {
      entry.old_bytes.resize(static_cast<std::size_t>(kept));
      file->real->pMethods->xRead(file->real, entry.old_bytes.data(), static_cast<int>(kept), offset);
    }
    plan().unsynced.push_back(std::move(entry));
  }
  static void forget(File* file) {
    plan().unsynced.remove_if([file](const Unsynced& entry) { return entry.file == file; });
  }
  [[noreturn]] static void die() {
    for (auto entry = plan().unsynced.rbegin(); entry != plan().unsynced.rend(); ++entry) {
      sqlite3_file* real = entry->file->real;
      if (!entry->old_bytes.empty())
        real->pMethods->xWrite(real, entry->old_bytes.data(), static_cast<int>(entry->old_bytes.size()),
                               entry->offset);
      real->pMethods->xTruncate(real, entry->old_size);
    }
    ::kill(::getpid(), SIGKILL);
    for (;;) ::pause();
  }

  static int open(sqlite3_vfs*, const char* name, sqlite3_file* file, int flags, int* out_flags) {
    File* ours = of(file);
    ours->real = reinterpret_cast<sqlite3_file*>(ours + 1);
    const int code = plan().real->xOpen(plan().real, name, ours->real, flags, out_flags);
    ours->base.pMethods = ours->real->pMethods ? &methods() : nullptr;
    return code;
  }
  static int write(sqlite3_file* file, const void* data, int amount, sqlite3_int64 offset) {
    const int count = ++writes();
    sqlite3_file* real = realOf(file);
    if (plan().fault != Fault::None && count >= plan().at_write) {
      if (plan().fault == Fault::Full) return SQLITE_FULL;
      if (plan().fault == Fault::TornKill) real->pMethods->xWrite(real, data, amount / 2, offset);
      die();
    }
    remember(of(file), offset, amount);
    return real->pMethods->xWrite(real, data, amount, offset);
  }
  static int truncate(sqlite3_file* file, sqlite3_int64 size) {
    sqlite3_int64 now = 0;
    realOf(file)->pMethods->xFileSize(realOf(file), &now);
    if (now > size) remember(of(file), size, now - size);
    return realOf(file)->pMethods->xTruncate(realOf(file), size);
  }
  static int sync(sqlite3_file* file, int flags) {
    const int code = realOf(file)->pMethods->xSync(realOf(file), flags);
    if (code == SQLITE_OK) forget(of(file));
    return code;
  }
  // A new project is synced as a whole after SQLite has closed it, so a closed file counts as synced.
  static int close(sqlite3_file* file) {
    forget(of(file));
    return realOf(file)->pMethods->xClose(realOf(file));
  }
  static int read(sqlite3_file* f, void* d, int n, sqlite3_int64 o) {
    return realOf(f)->pMethods->xRead(realOf(f), d, n, o);
  }
  static int fileSize(sqlite3_file* f, sqlite3_int64* s) {
    return realOf(f)->pMethods->xFileSize(realOf(f), s);
  }
  static int lock(sqlite3_file* f, int l) { return realOf(f)->pMethods->xLock(realOf(f), l); }
  static int unlock(sqlite3_file* f, int l) { return realOf(f)->pMethods->xUnlock(realOf(f), l); }
  static int checkLock(sqlite3_file* f, int* r) {
    return realOf(f)->pMethods->xCheckReservedLock(realOf(f), r);
  }
  static int control(sqlite3_file* f, int op, void* a) {
    return realOf(f)->pMethods->xFileControl(realOf(f), op, a);
  }
  static int sectorSize(sqlite3_file* f) { return realOf(f)->pMethods->xSectorSize(realOf(f)); }
  static int device(sqlite3_file* f) { return realOf(f)->pMethods->xDeviceCharacteristics(realOf(f)); }
  static int shmMap(sqlite3_file* f, int p, int n, int e, void volatile** pp) {
    return realOf(f)->pMethods->xShmMap(realOf(f), p, n, e, pp);
  }
  static int shmLock(sqlite3_file* f, int o, int n, int g) {
    return realOf(f)->pMethods->xShmLock(realOf(f), o, n, g);
  }
  static void shmBarrier(sqlite3_file* f) { realOf(f)->pMethods->xShmBarrier(realOf(f)); }
  static int shmUnmap(sqlite3_file* f, int d) { return realOf(f)->pMethods->xShmUnmap(realOf(f), d); }

  static const sqlite3_io_methods& methods() {
    static const sqlite3_io_methods table = {
        2,       close,      read,   write,  truncate, sync,       fileSize, lock,    unlock, checkLock,
        control, sectorSize, device, shmMap, shmLock,  shmBarrier, shmUnmap, nullptr, nullptr};
    return table;
  }

  sqlite3_vfs vfs_{};
};

}  // namespace tiltmap::test
