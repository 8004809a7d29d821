#pragma once

#include <memory>
#include <utility>

namespace der {

/// A member whose type only those need to know who use it: a pointer that owns its value and is as
/// constant as the object that it belongs to. Empty until `make_hidden`.
template <class T>
class Pimpl {
 public:
  Pimpl() = default;
  [[nodiscard]] const T& operator*() const { return *value_; }
  [[nodiscard]] T& operator*() { return *value_; }
  [[nodiscard]] const T* operator->() const { return value_.get(); }
  [[nodiscard]] T* operator->() { return value_.get(); }

  template <class U, class... Arguments>
  friend Pimpl<U> make_hidden(Arguments&&... arguments);

 private:
  using Delete = void (*)(T*);
  Pimpl(T* value, Delete deleter) : value_(value, deleter) {}
  std::unique_ptr<T, Delete> value_{nullptr, [](T*) {}};
};

template <class T, class... Arguments>
Pimpl<T> make_hidden(Arguments&&... arguments) {
  return {new T(std::forward<Arguments>(arguments)...), [](T* value) { delete value; }};
}

}  // namespace der
