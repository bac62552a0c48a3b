// The photographs of the current stop, read in the background.
#pragma once

#include <QAbstractListModel>
#include <QImage>
#include <QStringList>
#include <vector>

#include "core/project/project_snapshot.h"
#include "ui/models/background_worker.h"

namespace tiltmap::ui {

class Workspace;

// One row a photograph, in the order they were added. Decoration: a small picture, once it has been read.
class PhotographModel : public QAbstractListModel {
  Q_OBJECT

 public:
  explicit PhotographModel(Workspace& workspace, QObject* parent = nullptr);

  std::optional<ScanId> scan() const { return scan_; }
  const Photograph* photograph(int row) const;
  // At most kLargest_px on a side; null while it is being read and where it cannot be shown.
  QImage picture(int row) const;
  QString trouble(int row) const;  // why it cannot be shown; empty else
  bool isReading() const { return worker_.busy(); }

  // All of the files or none, as one edit. What is wrong is told by the workspace's messages.
  Status add(const QStringList& files, const QString& caption);
  Status remove(int row);
  // As it was put in.
  Status save(int row, const QString& file) const;
  QString proposedName(int row) const;  // "stop-4-2.jpg"

  int rowCount(const QModelIndex& parent = {}) const override;
  QVariant data(const QModelIndex& index, int role) const override;

  static constexpr int kLargest_px = 2048, kSmall_px = 96;

 Q_SIGNALS:
  void pictureRead(int row);

 private:
  struct Shown {
    Photograph photograph;
    QImage picture, small;
    QString trouble;
  };
  void refresh();
  void read();
  void take(std::int64_t photograph, const QImage& picture, const QString& trouble);
  Status told(Status status) const;

  Workspace& workspace_;
  std::optional<ScanId> scan_;
  std::vector<Shown> shown_;
  BackgroundWorker worker_;
};

// Pictures that a project takes, for file dialogs and for what is dropped on the window.
inline constexpr const char* kPictureFilter =
    "Pictures (*.jpg *.jpeg *.png *.webp *.gif *.tif *.tiff *.bmp *.heic);;All files (*)";
bool isPictureName(const QString& file);

}  // namespace tiltmap::ui
