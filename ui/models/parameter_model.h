// The parameters of an operation as a form fills them in.
#pragma once

#include <QObject>
#include <QString>
#include <optional>
#include <vector>

#include "core/project/operation.h"
#include "ui/models/preferences.h"

namespace tiltmap::ui {

// A preset, what was changed on top of it, and texts that are not values (yet). No widgets: the form shows
// it, and tests drive it without one.
class ParameterModel : public QObject {
  Q_OBJECT

 public:
  explicit ParameterModel(const Operation& operation, QObject* parent = nullptr);

  const Operation& operation() const { return operation_; }
  const std::vector<ParameterInfo>& infos() const { return operation_.parameters(); }
  const ParameterInfo& info(const QString& name) const;

  QString preset() const { return preset_; }
  // Every value becomes the preset's. A name that does not exist changes nothing.
  void setPreset(const QString& preset);

  QString valueText(const QString& name) const;
  // What the user typed. A text that is refused is kept and counts as an error until it is mended or reset.
  void setValueText(const QString& name, const QString& text);
  void setValue(const QString& name, const ParameterValue& value);
  std::optional<Error> error(const QString& name) const;
  bool hasErrors() const { return !errors_.empty(); }
  bool isChanged(const QString& name) const;  // differs from the preset
  int changedCount() const;
  void reset(const QString& name);  // to the preset's
  void resetAll();

  ParameterValues values() const { return values_; }  // all; wrong texts count as their last good value
  ParameterValues changes() const;                    // on top of the preset
  LastParameters last() const { return {preset_, changes()}; }
  // What of it still fits the operation; the rest is left out.
  void restore(const LastParameters& last);

 Q_SIGNALS:
  void valueChanged(const QString& name);
  void presetChanged();

 private:
  struct Refused {
    QString text;
    Error error;
  };

  const Operation& operation_;
  QString preset_ = "default";
  ParameterValues base_;  // the preset's
  ParameterValues values_;
  std::map<std::string, Refused> errors_;
};

// "max-distance" as a label: "Max distance".
QString parameterLabel(const ParameterInfo& info);
// What it does, unit, range, default, name on the command line and where it comes from; rich text.
QString parameterTip(const ParameterInfo& info);
QString parameterRange(const ParameterInfo& info);  // "0.01 to 100 m"; empty without bounds

}  // namespace tiltmap::ui
