#include "carat/io/vtk_session.h"

#include <vtkAlgorithm.h>
#include <vtkCommand.h>
#include <vtkExecutive.h>
#include <vtkLogger.h>
#include <vtkOutputWindow.h>
#include <vtkSmartPointer.h>

#include <algorithm>
#include <mutex>

#include "carat/base/error.h"

namespace carat::detail {
namespace {

/// "ERROR: In file, line 12\nvtkClass (0x1234): text\n\n" -> "text" in one line.
std::string essence(std::string text) {
  const std::size_t place = text.starts_with("ERROR: In ") ? text.find('\n') : std::string::npos;
  if (place != std::string::npos) text.erase(0, place + 1);
  const std::size_t object = text.find("): ");
  if (text.starts_with("vtk") && object != std::string::npos) text.erase(0, object + 3);
  for (char& c : text)
    if (c < ' ' || c > '~') c = ' ';
  text.resize(std::min<std::size_t>(text.size(), 200));
  while (!text.empty() && (text.back() == ' ' || text.back() == '.')) text.pop_back();
  return text;
}

/// Receives the errors of the objects that it observes.
class Observer : public vtkCommand {
 public:
  static Observer* New() { return new Observer; }
  void Execute(vtkObject*, unsigned long event, void* text) override {
    if (event == vtkCommand::ErrorEvent && text != nullptr) note(static_cast<const char*>(text));
  }
  void note(const char* text) {
    if (first_error.empty()) first_error = essence(text);
    if (first_error.empty()) first_error = "the library VTK cannot read it";
  }
  std::string first_error;
};

/// Receives the messages of all other objects.
class Window : public vtkOutputWindow {
 public:
  static Window* New() {
    auto* const window = new Window;
    window->InitializeObjectBase();
    return window;
  }
  void DisplayText(const char*) override {}
  void DisplayErrorText(const char* text) override { observer->note(text); }
  void DisplayWarningText(const char*) override {}
  void DisplayGenericWarningText(const char*) override {}
  void DisplayDebugText(const char*) override {}
  Observer* observer = nullptr;
};

std::mutex& turn() {
  static std::mutex mutex;
  return mutex;
}

}  // namespace

struct VtkSession::State {
  std::unique_lock<std::mutex> lock{turn()};
  vtkSmartPointer<Observer> observer = vtkSmartPointer<Observer>::New();
  vtkSmartPointer<Window> window = vtkSmartPointer<Window>::New();
  vtkSmartPointer<vtkOutputWindow> previous_window = vtkOutputWindow::GetInstance();
  vtkLogger::Verbosity previous_verbosity = vtkLogger::GetCurrentVerbosityCutoff();
};

VtkSession::VtkSession() : state_(std::make_unique<State>()) {
  state_->window->observer = state_->observer;
  vtkOutputWindow::SetInstance(state_->window);
  vtkLogger::SetStderrVerbosity(vtkLogger::VERBOSITY_OFF);
}

VtkSession::~VtkSession() {
  vtkLogger::SetStderrVerbosity(state_->previous_verbosity);
  vtkOutputWindow::SetInstance(state_->previous_window);
}

vtkCommand* VtkSession::observer() const { return state_->observer; }

void VtkSession::watch(vtkAlgorithm* algorithm) {
  for (const unsigned long event : {vtkCommand::ErrorEvent, vtkCommand::WarningEvent}) {
    algorithm->AddObserver(event, state_->observer);
    algorithm->GetExecutive()->AddObserver(event, state_->observer);
  }
}

const std::string& VtkSession::first_error() const { return state_->observer->first_error; }

void VtkSession::check() const {
  if (!first_error().empty())
    throw IoError(first_error() + "; the file is truncated or damaged, export it again");
}

}  // namespace carat::detail
