// What a relaxation is at, and what is asked about links, over the 3D view.
#pragma once

#include <QObject>

#include "ui/panels/panel.h"

class QToolButton;

namespace tiltmap::ui {

class CompareBar;
class Scene;
class SceneWidget;

// Follows the relaxation: marks the stops by set, with a legend in words, and switches the view's comparison
// on and off as the proposal's decision asks. All it is given outlives it.
class RelaxationOverlay : public QObject {
  Q_OBJECT

 public:
  RelaxationOverlay(const PanelContext& context, Scene& scene, SceneWidget& view, QToolButton& compare,
                    CompareBar& bar, QObject* parent);

 private:
  void refresh();
  void followCompare();

  PanelContext context_;
  Scene& scene_;
  SceneWidget& view_;
  QToolButton& compare_;
  CompareBar& bar_;
  bool switched_on_ = false;  // the comparison, by the decision and not by hand
};

}  // namespace tiltmap::ui
