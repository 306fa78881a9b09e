/* The station's style, after that of the reports, and its one script. */
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>

#include "report/measure/measure_page_parts.h"
#include "station/pages.h"
#include "station/trend.h"

static const char own[] =
    "nav{display:flex;flex-wrap:wrap;gap:4px;background:#16202a;padding:0 "
    "16px;position:sticky;top:0;"
    "z-index:2}nav a{color:#dfe4e9;text-decoration:none;padding:13px 20px;font-weight:600}"
    "nav a[aria-current]{background:var(--ground);color:var(--ink)}nav a:focus-visible{outline:3px "
    "solid #fff;outline-offset:-3px}\n"
    ".banner{background:#fff0d6;border:1px solid #e0b25c;border-radius:10px;padding:10px "
    "16px;margin:0 "
    "0 16px}\n"
    ".call{display:flex;flex-wrap:wrap;align-items:center;gap:12px "
    "28px;border-radius:10px;padding:14px "
    "24px;margin:0 0 16px;color:#fff;background:var(--soft)}.call "
    "b{font-size:clamp(54px,11vw,124px);"
    "line-height:1;letter-spacing:.01em}.call.small b{font-size:clamp(34px,6vw,52px)}.call "
    "span{font-size:22px;font-weight:600}.call.pass{background"
    ":var(--good)}.call.fail{background:var(--bad)}.call.again{background:var(--open)}.call.none{"
    "background:#3c5a78}\n"
    ".next{font-size:18px;margin:0 0 14px}.decided{list-style:none;padding:0;margin:0 0 "
    "16px;display:"
    "grid;grid-template-columns:repeat(auto-fit,minmax(260px,1fr));gap:10px}.decided li{background:"
    "var(--ground);border-left:6px solid var(--soft);border-radius:6px;padding:8px 14px}.decided "
    "li.pass{border-color:var(--good)}.decided li.fail{border-color:var(--bad)}.decided "
    "li.cannot_tell,.decided li.not_measured{border-color:var(--open)}.decided "
    "strong{display:block;"
    "font-size:20px;font-variant-numeric:tabular-nums}.decided "
    "small{color:var(--soft);font-size:14px}\n"
    "form.fields{display:flex;flex-wrap:wrap;gap:8px 14px;align-items:end;margin:0 0 "
    "16px}form.fields "
    "label{font-size:13px;color:var(--soft);display:grid;gap:2px}input,select,button{font:inherit;"
    "padding:8px 12px;border:1px solid #b9c2cb;border-radius:8px;background:#fff;min-height:42px}"
    "button{background:var(--blue);border-color:var(--blue);color:#fff;font-weight:600;cursor:"
    "pointer}"
    "button.big{font-size:20px;padding:10px 30px}input:focus-visible,select:focus-visible,"
    "button:focus-visible,a:focus-visible{outline:3px solid #1f6fd0;outline-offset:1px}\n"
    "ul.cards{list-style:none;padding:0;margin:0;display:grid;gap:6px}ul.cards li{display:flex;"
    "flex-wrap:wrap;gap:4px 16px;align-items:baseline;padding:7px 12px;background:var(--ground);"
    "border-radius:8px;overflow-wrap:anywhere}.tag.pass{background:#d9f0e3;color:#0b5c34}.tag.fail{"
    "background:#fbdcdc;color:#9c1c1c}.tag.again,.tag.card{background:#fff0d6;color:#7a4a00}"
    ".tag.none{background:#e1e9f2;color:#2b4561}\n";

/* Fields, pages of foils. */
static const char fields[] =
    "a.button{display:inline-block;padding:9px 16px;border:1px solid var(--blue);"
    "border-radius:8px;color:var(--blue);text-decoration:none;font-weight:600}\n"
    "table.left th,table.left td{text-align:left}table.left .tag{white-space:nowrap}"
    "td.text{max-width:180px;overflow-wrap:anywhere;white-space:normal}\n"
    ".paging{display:flex;gap:14px;align-items:center;margin:14px 0 0}"
    ".bed .tag{font-size:15px;text-decoration:none;display:inline-block;margin:0 6px 6px 0}\n"
    "form.fields input,form.fields select{width:136px}form.fields input[type=date]{width:160px}"
    "form.fields select[name=q],form.fields select[name=bump]{width:auto;min-width:136px}"
    "h1+form,h1+form.fields{margin-top:14px}\n";

static const char narrow[] =
    "@media(max-width:600px){.wide{display:none}nav{padding:0 4px}nav a{padding:12px 9px}"
    ".call{padding:12px 16px}form.fields input,form.fields select{width:calc(50vw - 35px)}"
    ".scroll>.picture{max-width:none;width:720px}}\n";

static const char print[] =
    "@media print{main{padding:0}nav,form,form.fields,.paging,.noprint,button{display:none}"
    "section{break-after:auto}h2{margin:10px 0 4px}td,th{line-height:1.25}"
    ".call{color:#000;background:#fff!important;border:3px solid #000;padding:6px 16px;"
    "margin:0 0 8px}.call b{font-size:46pt}.call.small b{font-size:26pt}"
    ".decided{grid-template-columns:1fr 1fr 1fr;gap:6px;margin:0 0 8px}"
    "dl.facts{grid-template-columns:max-content 1fr max-content "
    "1fr;font-size:8.5pt}th,td{padding:2px 4px}"
    ".decided strong{font-size:12pt}.picture{max-height:56mm}.many .picture{max-height:36mm}}\n";

/* New cards take the page's place, unless somebody is typing. The first field has the focus, and
 * what stands in it is marked, so that a barcode reader, which ends with Enter, writes over it.
 * The arrow keys turn pages. */
/* A bump of a foil. */
const char fg_station_icon[] =
    "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 32 32\"><rect width=\"32\" "
    "height=\"32\" rx=\"6\" fill=\"#16202a\"/><path d=\"M2 23H7Q16 -3 25 23H30\" fill=\"none\" "
    "stroke=\"#fff\" stroke-width=\"3.5\"/></svg>\n";

const char fg_station_script[] =
    "'use strict';\n"
    "(function(){\n"
    "var live=document.querySelector('[data-live]');\n"
    "function focus(){var f=document.querySelector('[data-focus]');if(f){f.focus();f.select();}}\n"
    "function busy(){var a=document.activeElement;return "
    "a&&a.tagName==='INPUT'&&a.value!==a.defaultValue;}\n"
    "function load(){fetch(location.href,{credentials:'same-origin'}).then(function(r){return "
    "r.text();})"
    ".then(function(t){if(busy())return;var d=new DOMParser().parseFromString(t,'text/html'),"
    "n=d.querySelector('main'),m=document.querySelector('main');if(!n||!m)return;m.replaceWith(n);"
    "focus();});}\n"
    "if(live&&window.EventSource){var e=new EventSource('/events');"
    "e.onmessage=function(m){if(m.data==='new')load();};}\n"
    "focus();\n"
    "document.addEventListener('keydown',function(k){var r=k.key==='ArrowLeft'?'prev':k.key==="
    "'ArrowRight'?'next':'',t=k.target.tagName,l=r&&document.querySelector('a[rel='+r+']');"
    "if(l&&!k.altKey&&!k.ctrlKey&&!k.metaKey&&t!=='INPUT'&&t!=='SELECT')l.click();});\n"
    "})();\n";

static char *whole;

static void join(void) {
  size_t size;
  FILE *out = open_memstream(&whole, &size);
  if (!out) return;
  fg_html_style(out);
  fputs(own, out);
  fputs(fields, out);
  fputs(narrow, out);
  fputs(print, out);
  fputs(fg_trend_style, out);
  fclose(out);
}

const char *fg_station_style_text(void) {
  static pthread_once_t once = PTHREAD_ONCE_INIT;
  pthread_once(&once, join);
  return whole ? whole : own;
}
