#include "ui/look/flow_layout.h"

#include <algorithm>

namespace tiltmap::ui {

FlowLayout::FlowLayout(QWidget* parent) : QLayout(parent) {}

FlowLayout::~FlowLayout() {
  while (QLayoutItem* item = takeAt(0)) delete item;
}

QLayoutItem* FlowLayout::takeAt(int index) {
  return index >= 0 && index < items_.size() ? items_.takeAt(index) : nullptr;
}

void FlowLayout::setGeometry(const QRect& rect) {
  QLayout::setGeometry(rect);
  arrange(rect, true);
}

QSize FlowLayout::sizeHint() const {
  const QMargins margins = contentsMargins();
  int width = margins.left() + margins.right() - spacing();
  int height = 0;
  for (const QLayoutItem* item : items_) {
    if (item->isEmpty()) continue;
    width += item->sizeHint().width() + spacing();
    height = std::max(height, item->sizeHint().height());
  }
  return {width, height + margins.top() + margins.bottom()};
}

QSize FlowLayout::minimumSize() const {
  const QMargins margins = contentsMargins();
  QSize size(0, 0);
  for (const QLayoutItem* item : items_) size = size.expandedTo(item->minimumSize());
  return size + QSize(margins.left() + margins.right(), margins.top() + margins.bottom());
}

int FlowLayout::arrange(const QRect& room, bool move) const {
  const QMargins margins = contentsMargins();
  const QRect inner = room.marginsRemoved(margins);
  // A line is filled first and placed then: its items stand at the middle of its height.
  QList<QLayoutItem*> line;
  int x = inner.left(), y = inner.top(), height = 0;
  const auto place = [&] {
    int at = inner.left();
    for (QLayoutItem* item : line) {
      const QSize size = item->sizeHint();
      if (move) item->setGeometry(QRect(QPoint(at, y + (height - size.height()) / 2), size));
      at += size.width() + spacing();
    }
    line.clear();
  };
  for (QLayoutItem* item : items_) {
    if (item->isEmpty()) continue;
    const QSize size = item->sizeHint();
    if (!line.isEmpty() && x + size.width() > inner.right() + 1) {
      place();
      y += height + std::max(2, spacing() / 2);
      x = inner.left();
      height = 0;
    }
    line.append(item);
    x += size.width() + spacing();
    height = std::max(height, size.height());
  }
  place();
  return y + height - room.top() + margins.bottom();
}

}  // namespace tiltmap::ui
