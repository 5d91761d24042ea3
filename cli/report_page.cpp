#include "cli/report_page.h"

#include <fstream>
#include <string_view>

#include "carat/base/atomic_file.h"
#include "carat/base/error.h"
#include "carat/report/viewer_template.h"

namespace carat::cli {

void write_report_page(Json report, const std::filesystem::path& path) {
  constexpr std::string_view title_mark = "<!--carat:title-->", data_mark = "<!--carat:data-->";
  const std::string_view page = detail::report_template();
  const std::size_t title_at = page.find(title_mark), data_at = page.find(data_mark);
  const std::size_t middle = title_at + title_mark.size();
  report["viewer"] = detail::viewer_template();
  std::string data = report.dump();
  // Nothing in it may end the script element.
  for (std::size_t at = 0; (at = data.find('<', at)) != std::string::npos;)
    data.replace(at, 1, "\\u003c");
  write_atomically(path, [&](const std::filesystem::path& temporary) {
    std::ofstream out(temporary, std::ios::binary);
    out << page.substr(0, title_at) << "Experiments" << page.substr(middle, data_at - middle)
        << "<script type=\"application/json\" id=\"report\">" << data << "</script>"
        << page.substr(data_at + data_mark.size());
    out.close();
    if (!out) throw IoError(path.string() + ": cannot be written completely; is the disk full?");
  });
}

}  // namespace carat::cli
