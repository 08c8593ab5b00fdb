#!/bin/sh
# Unpack LinuxCNC's stand-alone RS274/NGC interpreter (Debian 12 bookworm, amd64) WITHOUT
# installing linuxcnc-uspace (which pulls in 93 packages).  No root needed:
# `apt-get download` + `dpkg-deb -x`.      usage: sh tests/tools/get_rs274.sh .tools/rs274
# Result: PREFIX/bin/rs274 (wrapper), PREFIX/root/... (unpacked), PREFIX/empty.tbl (tool table)
set -eu
P=${1:?usage: sh tests/tools/get_rs274.sh .tools/rs274}
mkdir -p "$P/root" "$P/debs" "$P/bin"
P=$(cd "$P" && pwd)
R=$P/root
LP=$R/usr/lib:$R/usr/lib/x86_64-linux-gnu:$R/lib/x86_64-linux-gnu
cd "$P/debs"
get() { for p in "$@"; do apt-get download "$p"; dpkg-deb -x "$(ls -t "${p}"_*.deb | head -1)" "$R"; done; }
get linuxcnc-uspace libboost-python1.74.0
# shared libraries this machine lacks (none on a machine that has Python 3.11 development files)
for pass in 1 2 3 4; do
  miss=$(LD_LIBRARY_PATH=$LP ldd "$R/usr/bin/rs274" | sed -n 's/^[[:space:]]*\([^ ]*\) => not found.*/\1/p' | sort -u)
  [ -n "$miss" ] || break
  for l in $miss; do
    case $l in
      libpython3.11.so*) get libpython3.11 ;;
      libedit.so*) get libedit2 ;;            libbsd.so*) get libbsd0 ;;
      libmd.so*) get libmd0 ;;                libtirpc.so*) get libtirpc3 ;;
      libexpat.so*) get libexpat1 ;;          libz.so*) get zlib1g ;;
      libgssapi_krb5.so*) get libgssapi-krb5-2 ;;  libkrb5.so*) get libkrb5-3 ;;
      libk5crypto.so*) get libk5crypto3 ;;    libkrb5support.so*) get libkrb5support0 ;;
      libkeyutils.so*) get libkeyutils1 ;;    libcom_err.so*) get libcom-err2 ;;
      libssl.so*|libcrypto.so*) get libssl3 ;;
      libboost_python311*) get libboost-python1.74.0 ;;
      libstdc++.so*) get libstdc++6 ;;        libgcc_s.so*) get libgcc-s1 ;;
      libtinfo.so*) get libtinfo6 ;;
      *) echo "no package known for $l" >&2; exit 1 ;;
    esac
  done
done
# rs274 embeds Python 3.11: it needs that version's standard library
PH=
if [ ! -d /usr/lib/python3.11/encodings ]; then
  get libpython3.11-minimal libpython3.11-stdlib
  PH="PYTHONHOME=$R/usr; export PYTHONHOME"
fi
printf 'T1 P1 D0 ;no kerf\n' > "$P/empty.tbl"
cat > "$P/bin/rs274" <<W
#!/bin/sh
LD_LIBRARY_PATH=$LP\${LD_LIBRARY_PATH:+:\$LD_LIBRARY_PATH}
export LD_LIBRARY_PATH
$PH
exec $R/usr/bin/rs274 "\$@"
W
chmod +x "$P/bin/rs274"
printf 'G21 F100\nG1 X1\nM2\n' > "$P/selftest.ngc"
"$P/bin/rs274" -g -t "$P/empty.tbl" "$P/selftest.ngc" 2>/dev/null | grep -q 'STRAIGHT_FEED(1.0000' ||
  { echo "rs274 does not run" >&2; exit 1; }
echo "$P/bin/rs274"
