#include <vtkCommand.h>
#include <vtkNew.h>
#include <vtkXMLDataElement.h>
#include <vtkXMLDataParser.h>

#include <algorithm>
#include <charconv>
#include <cstring>
#include <string>

#include "carat/base/error.h"
#include "carat/io/scanner.h"
#include "carat/io/vtk_session.h"
#include "carat/io/vtk_xml.h"

namespace carat::detail {
namespace {

/// A count in the file, 0 if it is not there.
std::int64_t read_count(vtkXMLDataElement* element, const char* name, std::int64_t limit) {
  const char* const text = element->GetAttribute(name);
  if (text == nullptr) return 0;
  std::int64_t value = 0;
  const char* const end = text + std::strlen(text);
  const auto [stop, status] = std::from_chars(text, end, value);
  if (status != std::errc() || stop != end || value < 0)
    throw IoError(std::string(name) + " of " + element->GetName() +
                  " is not a number of elements; the file is damaged");
  if (value > limit)
    throw IoError(std::string(name) + " of " + element->GetName() + " is " + text +
                  ", more than the file can hold; it is truncated or damaged, export it again");
  return value;
}

/// Compares all counts below an element with `limit`, the number of values the file can hold.
void check_counts(vtkXMLDataElement* element, std::int64_t limit, std::int64_t rows, int depth) {
  if (depth > 32) throw IoError("XML elements are nested more than 32 deep; the file is damaged");
  std::int64_t points = read_count(element, "NumberOfPoints", limit / 3);
  std::int64_t total = points;
  for (const char* name :
       {"NumberOfCells", "NumberOfVerts", "NumberOfLines", "NumberOfStrips", "NumberOfPolys"})
    total = std::max(total, read_count(element, name, limit));
  rows = std::max({rows, total, read_count(element, "NumberOfTuples", limit)});
  read_count(element, "NumberOfComponents", limit / std::max<std::int64_t>(rows, 1));
  for (int i = 0; i < element->GetNumberOfNestedElements(); ++i)
    check_counts(element->GetNestedElement(i), limit, rows, depth + 1);
}

}  // namespace

std::string_view vtk_file_type(std::string_view content) {
  content = content.substr(0, 4096);
  const std::size_t start = content.find("<VTKFile");
  if (start == content.npos) return {};
  content = content.substr(start, content.find('>', start) - start);
  for (const char* key : {"type=\"", "type='"}) {
    const std::size_t value = content.find(std::string(" ") + key);
    if (value == content.npos) continue;
    const std::string_view rest = content.substr(value + 1 + std::strlen(key));
    return rest.substr(0, rest.find_first_of("\"'"));
  }
  return "?";
}

void check_vtk_xml(const FileContent& file, const char* type, VtkSession& session) {
  const std::string_view found = vtk_file_type(file.bytes);
  if (found.empty()) throw IoError("holds no element VTKFile, so it is no VTK XML file");
  if (found != type)
    throw IoError("holds VTK data of type " + in_quotes(found) +
                  "; PolyData or UnstructuredGrid is needed, extract the surface first");
  vtkNew<vtkXMLDataParser> parser;
  parser->AddObserver(vtkCommand::ErrorEvent, session.observer());
  parser->SetFileName(file.path.c_str());
  const bool parsed = parser->Parse() == 1;
  session.check();
  if (!parsed || parser->GetRootElement() == nullptr)
    throw IoError("malformed XML; the file is truncated or damaged, export it again");
  vtkXMLDataElement* const root = parser->GetRootElement();
  // No compressor that VTK knows packs more than this many values into a byte.
  constexpr std::int64_t kHighestCompression = 8192;
  const bool compressed = root->GetAttribute("compressor") != nullptr;
  check_counts(
      root, static_cast<std::int64_t>(file.bytes.size()) * (compressed ? kHighestCompression : 1),
      0, 0);
}

}  // namespace carat::detail
