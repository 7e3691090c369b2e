// Functions of a library that is loaded while the program runs, so that it need not be there to
// build with.
#pragma once

#include <dlfcn.h>

#include <cstring>
#include <string>

#include "server/base/plain_text.h"
#include "server/base/status.h"

namespace handrail {

// It stays loaded, unless it lacks a function: a vendor's may have threads of its own.
class LoadedLibrary {
 public:
  // `library`: a path, or a name that the loader knows. The error names it and the cause.
  static Result<LoadedLibrary> load(const std::string& library) {
    void* const handle = ::dlopen(library.c_str(), RTLD_NOW | RTLD_LOCAL);
    if (handle != nullptr) return LoadedLibrary(handle);
    const char* const cause = ::dlerror();
    return Status::error(shown(library, 200) +
                         ": cannot be loaded: " + shown(cause == nullptr ? "" : cause, 200));
  }

  // Looks a function up; null where there is none.
  template <typename Function>
  void take(const char* name, Function& out) {
    // The loader gives an object pointer for what is a function (dlsym(3)).
    void* const found = ::dlsym(handle_, name);
    static_assert(sizeof found == sizeof out);
    std::memcpy(&out, &found, sizeof out);
    if (found == nullptr && missing_ == nullptr) missing_ = name;
  }
  // The first function that was looked up in vain; null: all are there.
  const char* missing() const noexcept { return missing_; }
  void unload() noexcept { ::dlclose(handle_); }

 private:
  explicit LoadedLibrary(void* handle) : handle_(handle) {}

  void* handle_;
  const char* missing_ = nullptr;
};

}  // namespace handrail
