#include "ui/window/file_dialogs.h"

#include <QDir>
#include <QFileDialog>
#include <QFileInfo>

#include "ui/models/preferences.h"

namespace tiltmap::ui {

QFileDialog* askForFiles(QWidget* parent, Preferences& preferences, const FileAsked& asked,
                         std::function<void(const QStringList&)> answer) {
  auto* dialog = new QFileDialog(parent, asked.title);
  dialog->setAttribute(Qt::WA_DeleteOnClose);
  dialog->setNameFilters(asked.filter.split(";;"));
  dialog->setOption(QFileDialog::DontConfirmOverwrite);
  const QString folder_key = "folders/" + asked.key;
  const QString folder = preferences.text(folder_key, QDir::homePath());
  if (QFileInfo(folder).isDir()) dialog->setDirectory(folder);
  if (asked.question == FileQuestion::Save) {
    dialog->setAcceptMode(QFileDialog::AcceptSave);
    dialog->setFileMode(QFileDialog::AnyFile);
    dialog->setDefaultSuffix(asked.suffix);
    if (!asked.name.isEmpty()) dialog->selectFile(asked.name);
  } else {
    dialog->setFileMode(asked.question == FileQuestion::OpenMany ? QFileDialog::ExistingFiles
                                                                 : QFileDialog::ExistingFile);
  }
  QObject::connect(dialog, &QFileDialog::filesSelected, parent,
                   [&preferences, folder_key, answer = std::move(answer)](const QStringList& files) {
                     if (files.isEmpty()) return;
                     preferences.setText(folder_key, QFileInfo(files.front()).absolutePath());
                     answer(files);
                   });
  dialog->show();
  return dialog;
}

}  // namespace tiltmap::ui
