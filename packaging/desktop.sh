# Sourced by app/install and the tests: menu entry, file type and icons, for the person who runs it. Needs root (the checkout).
# They go below XDG_DATA_HOME, else ~/.local/share, and nowhere else.

desktop_folder() { printf '%s\n' "${XDG_DATA_HOME:-$HOME/.local/share}"; }

# A path as the Exec line of a desktop entry wants it: in quotes, with " ` $ and \ escaped, % doubled, and then every
# backslash once more, as in any value of the file.
exec_quoted() { printf '"%s"' "$(printf '%s' "$1" | sed -e 's/[\\"`$]/\\&/g' -e 's/%/%%/g' -e 's/\\/\\\\/g')"; }

refresh_desktop() {
  local data=$1
  # Each is there on a desktop; without one, nothing is to be told.
  if command -v update-mime-database >/dev/null; then update-mime-database "$data/mime" >/dev/null 2>&1 || true; fi
  if command -v update-desktop-database >/dev/null; then update-desktop-database -q "$data/applications" || true; fi
  if command -v gtk-update-icon-cache >/dev/null; then gtk-update-icon-cache -qtf "$data/icons/hicolor" 2>/dev/null || true; fi
}

install_desktop() {  # install_desktop PROGRAM
  local program=$1 data from="$root/resources"
  data=$(desktop_folder)
  mkdir -p "$data/applications" "$data/mime/packages" "$data/icons/hicolor/scalable/apps" "$data/icons/hicolor/scalable/mimetypes"
  local line
  while IFS= read -r line; do
    case $line in
      Exec=*) printf 'Exec=%s gui %%f\n' "$(exec_quoted "$program")" ;;
      TryExec=*) printf 'TryExec=%s\n' "$(printf '%s' "$program" | sed -e 's/\\/\\\\/g')" ;;
      *) printf '%s\n' "$line" ;;
    esac
  done <"$from/desktop/tiltmap.desktop" >"$data/applications/tiltmap.desktop"
  cp "$from/desktop/tiltmap.xml" "$data/mime/packages/tiltmap.xml"
  cp "$from/icons/tiltmap.svg" "$data/icons/hicolor/scalable/apps/tiltmap.svg"
  cp "$from/desktop/application-x-tiltmap.svg" "$data/icons/hicolor/scalable/mimetypes/application-x-tiltmap.svg"
  refresh_desktop "$data"
  if command -v xdg-mime >/dev/null; then xdg-mime default tiltmap.desktop application/x-tiltmap || true; fi
}

remove_desktop() {
  local data
  data=$(desktop_folder)
  rm -f "$data/applications/tiltmap.desktop" "$data/mime/packages/tiltmap.xml" \
    "$data/icons/hicolor/scalable/apps/tiltmap.svg" "$data/icons/hicolor/scalable/mimetypes/application-x-tiltmap.svg"
  refresh_desktop "$data"
}
