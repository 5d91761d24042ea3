// Surfaces side by side, with the bar of their colours.

#include <algorithm>

#include "cli/figure_drawing.h"
#include "cli/figure_numbers.h"

namespace carat::cli {
namespace {

constexpr Font kTitleFont{13, true, kBlack};
constexpr Font kTextFont{12, false, kBlack};
constexpr double kGap = 16;
constexpr double kBarWidth = 320;
constexpr double kBarHeight = 14;
constexpr int kBarSteps = 160;
constexpr int kBarTicks = 4;

}  // namespace

Size draw_picture(const Canvas& canvas, const PictureFigure& figure, double top) {
  const auto n = static_cast<double>(figure.images.size());
  const double width = (kFigureWidth - 2 * kFigureMargin - (n - 1) * kGap) / n;
  double x = kFigureMargin, bottom = top;
  for (const auto& [title, image] : figure.images) {
    canvas.text({x + width / 2, top + 10}, title, kTitleFont, Align::Center);
    const Size size{width, width * image.height / image.width};
    canvas.image({x, top + 22}, size, image);
    bottom = std::max(bottom, top + 22 + size.height);
    x += width + kGap;
  }
  const double left = (kFigureWidth - kBarWidth) / 2, bar = bottom + 14;
  const ColorScale& scale = figure.scale;
  const auto value_at = [&](double part) { return scale.low + part * (scale.high - scale.low); };
  for (int k = 0; k < kBarSteps; ++k) {
    const double step = kBarWidth / kBarSteps;
    // Steps overlap, so that no light shines through between them.
    canvas.fill_rectangle({left + k * step, bar},
                          {k + 1 < kBarSteps ? step + 0.5 : step, kBarHeight},
                          scale.at(value_at((k + 0.5) / kBarSteps)));
  }
  for (int k = 0; k <= kBarTicks; ++k) {
    const double part = static_cast<double>(k) / kBarTicks;
    canvas.text({left + part * kBarWidth, bar + kBarHeight + 10},
                number_text(value_at(part), 3, true), kTextFont, Align::Center);
  }
  canvas.text({kFigureWidth / 2, bar + kBarHeight + 28}, figure.value_title, kTextFont,
              Align::Center);
  return {kFigureWidth, bar + kBarHeight + 36 + kFigureMargin};
}

}  // namespace carat::cli
