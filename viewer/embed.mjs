// node embed.mjs PAGE.html OUT.cpp NAME: the page as a C++ function of that name (see
// viewer_template.h).
import { readFileSync, writeFileSync } from 'node:fs';

const [input, output, name] = process.argv.slice(2);
const bytes = readFileSync(input);
for (const mark of ['<!--carat:title-->', '<!--carat:data-->'])
  if (bytes.toString('utf8').split(mark).length !== 2)
    throw new Error(`${input}: "${mark}" must stand in the page exactly once`);

const lines = [];
for (let begin = 0; begin < bytes.length; begin += 32)
  lines.push(bytes.subarray(begin, begin + 32).join(','));

writeFileSync(
  output,
  `#include "carat/report/viewer_template.h"

namespace carat::detail {
namespace {
constexpr unsigned char page[] = {
${lines.join(',\n')}};
}  // namespace

std::string_view ${name}() {
  return {reinterpret_cast<const char*>(page), sizeof page};
}

}  // namespace carat::detail
`,
);
