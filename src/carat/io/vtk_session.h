#pragma once
// Keeps the library VTK quiet and collects what it has to say.

#include <memory>
#include <string>

class vtkAlgorithm;
class vtkCommand;

namespace carat::detail {

/// While one exists, VTK's messages go here instead of to the terminal. VTK's message window and
/// log are shared by the whole process: sessions take turns, and leave them as they were.
class VtkSession {
 public:
  VtkSession();
  ~VtkSession();
  VtkSession(const VtkSession&) = delete;
  VtkSession& operator=(const VtkSession&) = delete;

  void watch(vtkAlgorithm* algorithm);
  /// For objects that want an observer set.
  vtkCommand* observer() const;

  /// The first error so far, one line without VTK's file names; empty if there is none.
  const std::string& first_error() const;
  /// \throws IoError  if there was an error
  void check() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace carat::detail
